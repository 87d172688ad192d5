#!/usr/bin/env python3
"""Poses times seas: cameras from a hand above the water to 300 km up, near and ten million metres out, looking anywhere,
over seas from glass to hurricane. Pictures have the horizon where it must be and only light that can be, and the
projected grid of the same camera is a whole mesh."""

import itertools
import math

import numpy as np

from common import Campaign
import common_files
import common_shots

campaign = Campaign("Poses times seas: pictures and projected grids.", 360)
pelagic = common_files.module(campaign.program)

SEAS = {
    "calm": {"sea.wind_speed_mps": 0.0},
    "5 m/s": {"sea.wind_speed_mps": 5.0},
    "14 m/s": {"sea.wind_speed_mps": 14.0},
    "30 m/s": {"sea.wind_speed_mps": 30.0},
    "80 m/s": {"sea.wind_speed_mps": 80.0},
    "swell alone": {"sea.wind_speed_mps": 0.0,
                    "sea.swell": [{"height_m": 2.0, "period_s": 12.0, "direction_deg": 30.0}]},
    "shallow": {"sea.wind_speed_mps": 10.0, "sea.depth_m": 2.0, "sea.spectrum": "tma"},
    "trains": {"waves.model": "trochoid"},
    "loop": {"shot.loop_s": 10.0},
}
UNFOLDED = ("calm", "swell alone")
# Height and distance from the origin.
PLACES = [(0.3, 0.0), (2.0, 0.0), (10.0, 0.0), (1e3, 0.0), (2e4, 0.0), (3e5, 0.0), (10.0, 1e7), (1e3, 1e6),
          (10.0, 9e8)]
# Elevation of the line of sight.
LOOKS = {"straight down": -90.0, "down": -30.0, "at the horizon": 0.0, "up": 30.0, "straight up": 90.0}
ROLLS = [0.0, 0.0, 7.0, 90.0, 180.0, -135.0]
FIELDS = [1.0, 20.0, 50.0, 50.0, 120.0, 179.0]
CASES = list(itertools.product(LOOKS, PLACES, SEAS))
WIDTH, HEIGHT = 64, 36
AIR_M = 1e5  # above it there is none
EARTH_M = 6.371e6


def judge(draw, folder):
    # Few cases are spread over all of the table.
    look, (height_m, far_m), sea = CASES[draw.case * 101 % len(CASES)]
    elevation, azimuth = math.radians(LOOKS[look]), draw.uniform(-math.pi, math.pi)
    ahead = np.array([math.cos(elevation) * math.cos(azimuth), math.cos(elevation) * math.sin(azimuth),
                      math.sin(elevation)])
    if abs(LOOKS[look]) == 90.0:
        ahead[:2] = 0.0
    eye = np.array([far_m * math.cos(azimuth), far_m * math.sin(azimuth), height_m])
    roll, field = draw.choice(ROLLS), draw.choice(FIELDS)
    keys = {
        "shot.frames": [3, 3], **SEAS[sea], "quality.level": "draft", "surface.kind": "projected-grid",
        "camera.resolution": [WIDTH, HEIGHT], "light.sun_elevation_deg": draw.choice([5.0, 20.0, 60.0, 90.0]),
        "light.sun_azimuth_deg": draw.uniform(0, 360),
        "camera.keys": [{"frame": 3, "position_m": eye.tolist(), "look_at_m": (eye + 100 * ahead).tolist(),
                         "fov_deg": field, "roll_deg": roll}],
    }
    shot = folder / "shot.toml"
    shot.write_text(common_shots.shot_text(keys), encoding="utf-8")
    scene = pelagic.Scene.from_file(str(shot))
    words = f"{look} from {height_m:g} m, {far_m:g} m out, {field:g} degrees wide, rolled by {roll:g}, {sea}"

    out = folder / "pictures"
    done = campaign.run("render", shot, "--out", out, "--samples", "1", timeout=300)
    campaign.ended_well(done, (0, 2, 75))
    if done.status:
        campaign.expect(str(shot) in done.err and not out.exists(), f"{words}: refused, but how", done)
        campaign.expect("memory" in done.err or height_m < 3 * scene.significant_height_m(),
                        f"{words}: refused high above the waves", done)
        campaign.count("pictures refused")
    else:
        campaign.count("pictures")
        held = common_files.check_folder(pelagic, out)
        judge_picture(words, scene, held, eye, rays(ahead, *axes(ahead, roll), field))

    out = folder / "mesh"
    done = campaign.run("bake", shot, "--out", out, timeout=300)
    campaign.ended_well(done, (0, 2, 75))
    if done.status:
        campaign.expect(str(shot) in done.err and not out.exists(), f"{words}: grid refused, but how", done)
        campaign.count("grids refused")
    else:
        campaign.count("grids")
        held = common_files.check_folder(pelagic, out)
        mesh = next(value for name, value in held.items() if name.startswith("mesh/") and "0003" in name)
        judge_grid(words, sea, mesh, eye, np.stack([*axes(ahead, roll), ahead]), math.tan(math.radians(field / 2)))


def axes(ahead, roll_deg):
    """The picture's right and up: level, or north up along z; rolled, its right side goes down."""
    across = np.cross(ahead, (0.0, 0.0, 1.0) if abs(ahead[2]) < 1.0 else (0.0, 1.0, 0.0))
    right = across / np.linalg.norm(across)
    up, roll = np.cross(right, ahead), math.radians(roll_deg)
    right, up = right * math.cos(roll) - up * math.sin(roll), up * math.cos(roll) + right * math.sin(roll)
    return right, up


def rays(ahead, right, up, field_deg):
    """(HEIGHT + 1, WIDTH + 1, 3) directions through the pixels' corners, rows from the top."""
    half = math.tan(math.radians(field_deg / 2))
    x = half * (2 * np.arange(WIDTH + 1) / WIDTH - 1)
    y = half * (1 - 2 * np.arange(HEIGHT + 1) / HEIGHT) * HEIGHT / WIDTH
    out = ahead + x[None, :, None] * right + y[:, None, None] * up
    return out / np.linalg.norm(out, axis=-1, keepdims=True)


def judge_picture(words, scene, held, eye, corners):
    picture = next(value for name, value in held.items() if name.endswith(".exr"))
    png = next(value for name, value in held.items() if name.endswith(".png"))
    layers = {layer: np.stack([picture[f"{layer}.{c}"] for c in "RGB"], axis=-1).astype("f8")
              for layer in ("sun", "sky", "sea", "foam")}
    total = np.stack([picture[c] for c in "RGB"], axis=-1)
    # Over the crests the horizon is level: no ray that rises meets water, and each that falls does.
    slopes = corners[..., 2]
    around = np.stack([slopes[:-1, :-1], slopes[1:, :-1], slopes[:-1, 1:], slopes[1:, 1:]])
    sky, sea = around.min(axis=0) > 1e-3, around.max(axis=0) < -1e-3
    # From above the air there is light from below alone, and none from past the earth, which is round.
    lowest = (EARTH_M + eye[2]) * np.sqrt(1.0 - np.minimum(around.max(axis=0), 0.0)**2) - EARTH_M
    lit = (sea & (lowest < 0.9 * AIR_M)) | (eye[2] < AIR_M)
    campaign.expect((total[lit].max(axis=-1) > 0).all(), f"{words}: a black pixel in daylight")
    if lit.any():
        campaign.expect(np.ptp(total) > 0 and np.ptp(total) > 1e-4 * total.max(), f"{words}: all of one colour")
        # Straight down into clear water it is dark.
        bright = 20 if slopes.max() > 0 else 4
        campaign.expect(png.max() > bright and png.min() < 255, f"{words}: the PNG is {png.min()} … {png.max()}")
    if eye[2] > 2 * scene.significant_height_m() + 0.2:
        for layer in ("sea", "foam"):
            campaign.expect(not layers[layer][sky].any(), f"{words}: {layer} in {(layers[layer][sky] > 0).sum()} "
                            "samples above the horizon")
        # The water's own light, where air doesn't hide it.
        near = sea & (eye[2] / np.maximum(-around.max(axis=0), 1e-9) < 2e4)
        campaign.expect((layers["sea"][near].max(axis=-1) > 0).all(), f"{words}: pixels below the horizon without sea")
    # Light that can be: mirrors are no brighter than what they show, and what scatters shares what comes in. Above the
    # horizon the sky has the sun's disc.
    light = pelagic.Sky(scene)
    brightest = light.image(256)[:128].reshape(-1, 3).max(axis=0)
    incoming = np.asarray(light.sun_irradiance) + np.asarray(light.sky_irradiance)
    for layer, bound in (("sky", 1.5 * brightest), ("sea", incoming / math.pi), ("foam", incoming / math.pi),
                         ("sun", np.asarray(light.sun_radiance) * 1.01)):
        values = layers[layer][sea]
        campaign.expect((values <= bound * 1.01 + 1e-9).all(),
                        f"{words}: {layer} up to {values.max(axis=0, initial=0)}, it may {bound}")


def judge_grid(words, sea, mesh, eye, camera, half_width):
    """camera: right, up and ahead."""
    points = mesh["position"].astype("f8") + mesh.get("origin_m", 0.0) - eye
    if not len(mesh["face_corners"]):
        campaign.count("grids of nothing")
        return
    campaign.expect((mesh["face_counts"] == 4).all(), f"{words}: faces that aren't quads")
    quads = points[mesh["face_corners"].reshape(-1, 4)]
    area = 0.5 * np.cross(quads[:, 2] - quads[:, 0], quads[:, 3] - quads[:, 1])
    size = np.linalg.norm(area, axis=-1)
    campaign.expect((size > 0).all(), f"{words}: {(size == 0).sum()} of {len(size)} quads have no area")
    if sea in UNFOLDED:
        # In the picture: round the nadir and in the margins, rows of other widths meet.
        across, along, depth = camera @ quads.mean(axis=1).T
        seen = (depth > 0) & (abs(across) < half_width * depth) & (abs(along) < half_width * HEIGHT / WIDTH * depth)
        down = seen & (area[:, 2] <= 0)
        campaign.expect(not down.any(), f"{words}: {down.sum()} of {seen.sum()} quads in the picture lie face down")


campaign.go(judge)
