// What lights read from files: IES profiles (delegate/translate/look/ies_file.h) and images.
#include <cmath>
#include <doctest/doctest.h>
#include <limits>
#include <string>

#include "core/base/error.h"
#include "core/shade/light/shaping.h"
#include "delegate/translate/look/ies_file.h"
#include "delegate/translate/look/light_picture.h"

using namespace msbvh;
using namespace msbvh::translate;

namespace {

// A file with these angles and intensities; multiplier 2, ballast factor 0.5.
std::string file(const std::string& vertical, const std::string& horizontal, const std::string& candela,
                 const std::string& counts, const std::string& tilt = "TILT=NONE", int type = 1) {
  return "IESNA:LM-63-2002\r\n[TEST] TILT= in a label\r\n" + tilt + "\r\n1 1000 2 " + counts + " " +
         std::to_string(type) + " 2 0.1, 0.2 0\r\n0.5 1 50\r\n" + vertical + "\r\n" + horizontal + "\r\n" +
         candela + "\r\n";
}

std::string complaint(const std::string& text) {
  try {
    parse_ies(text);
  } catch (const Error& error) {
    return error.what();
  }
  return "none";
}

}  // namespace

TEST_CASE("IES: one plane holds all around; factors multiply") {
  const IesProfile profile = parse_ies(file("0 45 90", "0", "100 50 0", "3 1"));
  CHECK(profile.horizontal == std::vector<float>{0, 360});
  for (const float around : {0.0f, 77.0f, 359.0f}) {
    CHECK(ies_intensity(profile, 0.0f, around) == doctest::Approx(100.0));
    CHECK(ies_intensity(profile, 60.0f, around) == doctest::Approx(50.0 * 2 / 3));
  }
}

TEST_CASE("IES: a quadrant and a half are mirrored, a whole turn is kept, a turn without its end is closed") {
  const IesProfile quarter = parse_ies(file("0 90", "0 30 90", "1 1  2 2  3 3", "2 3"));
  CHECK(quarter.horizontal == std::vector<float>{0, 30, 90, 150, 180, 210, 270, 330, 360});
  for (const float around : {30.0f, 150.0f, 210.0f, 330.0f})
    CHECK(ies_intensity(quarter, 10.0f, around) == doctest::Approx(2.0));
  const IesProfile half = parse_ies(file("0 90", "0 60 180", "1 1  2 2  3 3", "2 3"));
  CHECK(half.horizontal == std::vector<float>{0, 60, 180, 300, 360});
  CHECK(ies_intensity(half, 10.0f, 300.0f) == doctest::Approx(2.0));
  const IesProfile open = parse_ies(file("0 90", "0 90.5 200 300", "1 1  2 2  3 3  4 4", "2 4"));
  CHECK(open.horizontal.back() == 360.0f);
  CHECK(ies_intensity(open, 10.0f, 330.0f) == doctest::Approx(2.5));
}

TEST_CASE("IES: 90 to 270 degrees are mirrored about their plane") {
  const IesProfile profile = parse_ies(file("0 90", "90 150 210 270", "1 1  2 2  3 3  4 4", "2 4"));
  const auto at = [&](float around) { return ies_intensity(profile, 10.0f, around); };
  for (const float around : {91.0f, 120.0f, 150.0f, 170.0f, 200.0f, 250.0f, 269.0f}) {
    CAPTURE(around);
    CHECK(at(around) == doctest::Approx(at(std::fmod(540.0f - around, 360.0f))).epsilon(1e-4));
  }
  CHECK(at(150.0f) == doctest::Approx(2.0));
  CHECK(at(30.0f) == doctest::Approx(2.0));
  CHECK(at(0.0f) == doctest::Approx(2.5));
  CHECK(at(0.0f) == doctest::Approx(at(360.0f)));
}

TEST_CASE("IES: power is the mean over the half or the whole sphere") {
  CHECK(parse_ies(file("0 90", "0", "7 7", "2 1")).power == doctest::Approx(7.0));
  CHECK(parse_ies(file("0 90 180", "0 360", "7 7 7 7 7 7", "3 2")).power == doctest::Approx(7.0));
  CHECK(parse_ies(file("0 60", "0", "8 8", "2 1")).power == doctest::Approx(4.0));  // half of the half sphere
}

TEST_CASE("IES: a tilt that the file holds is passed over") {
  const std::string tilt = "TILT=INCLUDE\r\n1\r\n3\r\n0 45 90\r\n1 0.9 0.8";
  CHECK(parse_ies(file("0 90", "0", "7 7", "2 1", tilt)).candela == std::vector<float>{7, 7, 7, 7});
}

// Of floodlights: vertical angles turn about the horizontal axis, horizontal ones lead out of that plane.
TEST_CASE("IES: type B, and type A with the two angles in each other's place") {
  const std::string vertical = "-90 0 90", horizontal = "-90 0 90", candela = "0 0 0  10 100 20  0 40 0";
  const IesProfile b = parse_ies(file(vertical, horizontal, candela, "3 3", "TILT=NONE", 2));
  CHECK(b.vertical.size() == 181);
  CHECK(b.horizontal.size() == 361);
  CHECK(ies_intensity(b, 0.0f, 0.0f) == doctest::Approx(100.0));
  CHECK(ies_intensity(b, 45.0f, 0.0f) == doctest::Approx(70.0));    // right, in the plane
  CHECK(ies_intensity(b, 45.0f, 180.0f) == doctest::Approx(50.0));  // left
  CHECK(ies_intensity(b, 45.0f, 90.0f) == doctest::Approx(60.0));   // up
  CHECK(ies_intensity(b, 45.0f, 270.0f) == doctest::Approx(55.0));  // down
  CHECK(ies_intensity(b, 135.0f, 45.0f) == 0.0f);                   // behind
  // 45 degrees to each side: of type B 45 degrees about the horizontal axis, then asin(1/sqrt 3) out of the
  // plane.
  const float off = 54.7356f;
  const float across = 35.2644f;
  CHECK(ies_intensity(b, off, 45.0f) ==
        doctest::Approx((1 - across / 90) * 60 + across / 90 * 20).epsilon(2e-2));
  const IesProfile a = parse_ies(file(vertical, horizontal, candela, "3 3", "TILT=NONE", 3));
  CHECK(ies_intensity(a, off, 45.0f) ==
        doctest::Approx((1 - across / 90) * 70 + across / 90 * 10).epsilon(2e-2));
}

TEST_CASE("IES: what begins at 0 of types A and B is the same on both sides") {
  const IesProfile b = parse_ies(file("0 90", "0 90", "100 20  40 0", "2 2", "TILT=NONE", 2));
  for (const float around : {0.0f, 180.0f}) CHECK(ies_intensity(b, 45.0f, around) == doctest::Approx(70.0));
  for (const float around : {90.0f, 270.0f}) CHECK(ies_intensity(b, 45.0f, around) == doctest::Approx(60.0));
}

TEST_CASE("IES: what is wrong is said, with its line") {
  CHECK(complaint("") == "found no line TILT=; expected an IES file");
  CHECK(complaint("IESNA\n[X] TILT=NONE\n") == "found no line TILT=; expected an IES file");
  CHECK(complaint(file("0 90", "0", "7", "2 1")) ==
        "line 9: found the end of the file; expected candela values");
  CHECK(complaint(file("0 90", "0", "7 nan", "2 1")) ==
        "line 8: found \"nan\"; expected candela values, a finite number");
  CHECK(complaint(file("0 90", "0", "7\r\nx", "2 1")).starts_with("line 9: found \"x"));
  CHECK(complaint(file("0 90", "0", "7 -1", "2 1")).starts_with("line 8: found -1.000000 candela"));
  CHECK(complaint(file("90 0", "0", "7 7", "2 1"))
            .ends_with("expected vertical angles that increase, 0 to 180"));
  CHECK(complaint(file("0 90", "45 60", "7 7 7 7", "2 2")).find(": found horizontal angles from 45") !=
        std::string::npos);
  CHECK(complaint(file("0 90", "0", "7 7", "2 1e9")).find("expected a number of horizontal angles") !=
        std::string::npos);
  CHECK(complaint(file("10 90", "0", "7 7", "2 1", "TILT=NONE", 2))
            .starts_with("line 6: found vertical angles from 10"));
  const std::string other = file("0 90", "0", "7 7", "2 1", "TILT=NONE", 4);
  CHECK(complaint(other) == "line 4: found 4.000000; expected a photometric type (1: C, 2: B, 3: A), 1 to 3");
  for (std::size_t length = 0; length < other.size(); length += 7) complaint(other.substr(0, length));
}

TEST_CASE("light picture: what is not finite is mended and counted") {
  const float inf = std::numeric_limits<float>::infinity();
  const LightPicture picture =
      light_picture("sky", ImageMap::kLatlong, 2, 2, {{NAN, 1, 1}, {inf, -inf, 2}, {-3, 0, 0}, {1, 1, 1}});
  CHECK(picture.mended == 2);
  CHECK(picture.image->texels[0] == Vec3f{0, 1, 1});
  CHECK(picture.image->texels[1] == Vec3f{kBrightestTexel, 0, 2});
  CHECK(picture.image->texels[2] == Vec3f{0, 0, 0});
}

TEST_CASE("light picture: a huge one becomes smaller, its mean stays") {
  const std::uint32_t width = 8192, height = 2048;
  std::vector<Vec3f> texels(std::size_t(width) * height, Vec3f{1, 1, 1});
  for (std::size_t i = 0; i < texels.size(); i += 2) texels[i] = {3, 3, 3};
  const LightPicture picture = light_picture("sky", ImageMap::kRect, width, height, std::move(texels));
  CHECK(picture.image->width == width / 2);
  CHECK(picture.image->height == height / 2);
  CHECK(picture.image->mean == doctest::Approx(2.0));
}

TEST_CASE("light picture: formats of domes") {
  CHECK(dome_map("automatic") == ImageMap::kLatlong);
  CHECK(dome_map("mirroredBall") == ImageMap::kMirroredBall);
  CHECK_FALSE(dome_map("cubeMapVerticalCross"));
}
