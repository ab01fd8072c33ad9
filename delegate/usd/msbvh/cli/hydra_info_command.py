"""`msbvh hydra-info`."""

from __future__ import annotations

import json
from pathlib import Path

import click

from ..base.exit_codes import DONE, WRONG
from ..base.reporter import Reporter
from ..hydra_info.plugin import SEARCH_PATH, Plugin, PluginError, find_host, find_plugin, search_folders, version_of


@click.command("hydra-info")
@click.option(
    "--plugin",
    type=click.Path(path_type=Path),
    help=f"Folder of the plugin's plugInfo.json; without it those of {SEARCH_PATH}.",
)
@click.option(
    "--host",
    type=click.Path(exists=True, path_type=Path),
    help="An OpenUSD library, or a folder that holds one, such as an application's: can it load the plugin?",
)
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def hydra_info_command(plugin: Path | None, host: Path | None, as_json: bool) -> int:
    """Where the Hydra plugin is, which OpenUSD it was built for, and whether a host can load it. Nothing is loaded: the
    version stands in the names of the symbols that both share.

    Exit code 1 if there is no plugin, or the host cannot load it.
    """
    reporter = Reporter()
    folders = [plugin] if plugin is not None else search_folders()
    try:
        found = find_plugin(folders)
    except PluginError as error:
        reporter.error(str(error))
        return WRONG
    if found is None:
        where = ", ".join(map(str, folders)) or f"{SEARCH_PATH}, which names no folder"
        reporter.error(f"found no plugin hdMsbvh in {where}; expected the folder of its plugInfo.json")
        return WRONG
    facts = _facts(found) | ({} if host is None else _fit(found, host))
    print(json.dumps(facts, indent=2) if as_json else "\n".join(f"{name}: {fact}" for name, fact in facts.items()))
    return WRONG if facts.get("loads") == "no" or not found.library.is_file() else DONE


def _facts(plugin: Plugin) -> dict[str, str]:
    namespace = plugin.namespace
    return {
        "plugin": str(plugin.folder),
        "library": str(plugin.library) + ("" if plugin.library.is_file() else " (missing)"),
        "version": plugin.version,
        "OpenUSD": version_of(namespace) if namespace else plugin.openusd or "unknown",
    }


def _fit(plugin: Plugin, path: Path) -> dict[str, str]:
    host = find_host(path)
    if host is None:
        return {"host": f"{path} (no OpenUSD library found)", "loads": "no"}
    fits = plugin.namespace == host.namespace
    return {"host": f"{host.library} (OpenUSD {version_of(host.namespace)})", "loads": "yes" if fits else "no"}
