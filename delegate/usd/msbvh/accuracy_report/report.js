// Copies commands, sorts the table of prims, compares pictures, and marks where the reader is. Needs no network.
"use strict";

// Commands -----------------------------------------------------------------------------------------------------------

async function copyText(text) {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    // A page from a disk may not have the clipboard: the old way still works there.
    const area = document.createElement("textarea");
    area.value = text;
    document.body.append(area);
    area.select();
    const done = document.execCommand("copy");
    area.remove();
    if (!done) throw new Error("no clipboard");
  }
}

for (const button of document.querySelectorAll("button.copy")) {
  const label = button.textContent;
  button.addEventListener("click", async () => {
    try {
      await copyText(button.dataset.copy);
      button.textContent = "Copied";
    } catch {
      button.textContent = "Not copied";
    }
    button.focus();
    setTimeout(() => { button.textContent = label; }, 1500);
  });
}

// Sorting ------------------------------------------------------------------------------------------------------------

// Numbers by size, text by the alphabet; what is missing stands last in either direction.
function sortTable(table, column, direction) {
  const body = table.tBodies[0];
  const key = (row) => row.cells[column].dataset.sort;
  const numeric = [...body.rows].every((row) => key(row) === "" || !Number.isNaN(Number(key(row))));
  const compare = numeric
    ? (a, b) => Number(a) - Number(b)
    : (a, b) => a.localeCompare(b, "en", { numeric: true });
  const rows = [...body.rows].sort((one, other) => {
    const [a, b] = [key(one), key(other)];
    if (a === "" || b === "") return (a === "") - (b === "");
    return direction * compare(a, b);
  });
  body.append(...rows);
}

for (const table of document.querySelectorAll("table.sorts")) {
  const heads = [...table.tHead.rows[0].cells];
  heads.forEach((head, column) => {
    head.querySelector("button").addEventListener("click", () => {
      // Figures start with the largest, which is what one looks for; text with A.
      const first = head.classList.contains("n") ? "descending" : "ascending";
      const second = first === "ascending" ? "descending" : "ascending";
      const order = head.getAttribute("aria-sort") === first ? second : first;
      heads.forEach((each) => each.removeAttribute("aria-sort"));
      head.setAttribute("aria-sort", order);
      sortTable(table, column, order === "ascending" ? 1 : -1);
    });
  });
}

// Pictures -----------------------------------------------------------------------------------------------------------

function comparePictures() {
  const source = document.getElementById("picture-data");
  if (!source) return;
  const choices = JSON.parse(source.textContent);
  const element = (id) => document.getElementById(id);
  const [left, right, split] = [element("left"), element("right"), element("split")];

  const show = () => {
    const [one, other] = [choices[left.value], choices[right.value]];
    element("left-picture").src = one.picture;
    element("left-picture").alt = one.label;
    element("right-picture").src = other.picture;
    element("right-picture").alt = other.label;
    element("split-caption").textContent = `Left: ${one.label}. Right: ${other.label}.`;
    const map = element("error-map");
    map.hidden = !one.error_map;
    element("no-error-map").hidden = Boolean(one.error_map);
    if (one.error_map) map.src = one.error_map;
    else map.removeAttribute("src");
    map.alt = `FLIP error map of ${one.label}`;
    element("error-caption").textContent = one.error_map ? `Where the left picture differs from the reference (FLIP): brighter is worse.` : "";
  };
  const cut = () => {
    element("slider").style.setProperty("--split", `${split.value}%`);
    split.setAttribute("aria-valuetext", `${split.value} per cent`);
  };
  left.addEventListener("change", show);
  right.addEventListener("change", show);
  split.addEventListener("input", cut);
  show();
  cut();
}
comparePictures();

// Contents -----------------------------------------------------------------------------------------------------------

// The last section that begins above the upper third of the window is the one that is read.
function markCurrent() {
  const links = [...document.querySelectorAll(".contents a")];
  const sections = links.map((link) => document.querySelector(link.getAttribute("href")));
  let waiting = false;
  const mark = () => {
    waiting = false;
    let current = 0;
    sections.forEach((section, i) => {
      if (section && section.getBoundingClientRect().top < innerHeight / 3) current = i;
    });
    links.forEach((link, i) => {
      if (i === current) link.setAttribute("aria-current", "true");
      else link.removeAttribute("aria-current");
    });
  };
  addEventListener("scroll", () => {
    if (!waiting) requestAnimationFrame(mark);
    waiting = true;
  }, { passive: true });
  mark();
}
markCurrent();
