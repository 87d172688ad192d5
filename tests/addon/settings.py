"""Every property at both ends of its range, and each choice: a sea, or a sentence that says why there is none."""

import math
import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from harness import *  # noqa: F403

enable()
import pelagic
from pelagic_ocean import ocean, panels, play, properties, translations

scene = bpy.context.scene
obj = add_ocean(effects__foam_decay_s=pelagic.Scene().effects.foam_decay_s)
obj.pelagic.viewport_percentage = 1  # so that the largest resolution is one that can be tried
TOO_LARGE = {"waves.cascades[].resolution"}  # gigabytes at its upper end: asked for, not built


def settle():
    """The sea as it is now: None, or why there is none."""
    bpy.context.view_layer.update()
    simulation = play.simulation_of(obj)
    if simulation.problem:
        return simulation.problem
    assert np.isfinite(numbers(obj.data)).all()
    return None


def ends(key):
    """Values at both ends of a property, or all its choices."""
    if key["type"] in ("number", "integer"):
        low, high = key["range"]
        return low, min(high, properties.INTEGER_LIMIT) if key["type"] == "integer" else high
    if key["type"] == "truth":
        return False, True
    if key["type"] == "point":
        return tuple((bound,) * 3 for bound in key["range"])
    words = key["choices"]
    if key["type"] == "word":
        return words
    if key["type"] == "words":
        return set(), set(words)
    return ("", "no such file.exr")


# Names and abbreviations, which German writes as they are.
SAME = {"JONSWAP", "TMA", "FFT", "USDA", "USDC", "Elfouhaily", "Phillips", "Hasselmann", "Omega 2", "Monahan 1980", "Monahan 1986", "Andreas 1998",
        "Callaghan 2008", "Planet", "Chlorophyll", "Voxel", "Pelagic", "Presets", "Level Set", "Jerlov I", "Jerlov IA", "Jerlov IB", "Jerlov II", "Jerlov III", "Jerlov 1C",
        "Jerlov 3C", "Jerlov 5C", "Jerlov 7C", "Jerlov 9C"}
BLENDERS = {"", "Check and warn on overwriting existing files", "Filepath used for exporting the file", "Filepath used for importing the file"}
with checking("a drop-down can choose each word, and be keyed with each"):
    plain = bpy.data.objects.new("Plain", None)
    scene.collection.objects.link(plain)
    for field in (field for field in properties.FIELDS if field.key["type"] == "entries"):
        getattr(getattr(plain.pelagic, field.table), field.name).add()
    drop_downs = list(ocean._drop_downs(plain))
    for field, group, path in drop_downs:
        items = {item.identifier: item.value for item in group.bl_rna.properties[field.name].enum_items}
        assert list(items) == list(field.key["choices"]) and len(set(items.values())) == len(items), items
        # Files of before are brought to today's numbers again and again, as actions that two oceans share are.
        assert all(properties.word_before(field, number) in (None, word) for word, number in items.items()), items
        for frame, word in enumerate(items, 1):
            setattr(group, field.name, word)
            assert getattr(group, field.name) == word
            plain.keyframe_insert(path, frame=frame)
    keyed_words = 0
    for frame in range(1, 1 + max(len(field.key["choices"]) for field, _, _ in drop_downs)):
        scene.frame_set(frame)
        for field, group, path in drop_downs:
            word = (*field.key["choices"], *[field.key["choices"][-1]] * frame)[frame - 1]
            assert getattr(group, field.name) == word, (path, word, getattr(group, field.name))
            keyed_words += frame <= len(field.key["choices"])
    assert len(drop_downs) >= 15 and keyed_words > 50, (len(drop_downs), keyed_words)
    bpy.data.objects.remove(plain)
    scene.frame_set(1)

with checking("each label, operator and sentence has German words, with the same numbers in them; Blender says them while it is on"):
    def names(rna):
        shown = [each for each in rna.properties if not each.is_hidden and each.name != each.identifier
                 and (each.identifier not in ("name", "rna_type") and not each.identifier.startswith("bl_"))]
        return {each.name for each in shown} | {item.name for each in shown if each.type == "ENUM" for item in each.enum_items}

    said = {getattr(bpy.types, name).bl_label for name in dir(bpy.types) if name.startswith("PELAGIC_")
            and hasattr(getattr(bpy.types, name), "bl_label")}
    for each in (*bpy.types.PropertyGroup.__subclasses__(), *(getattr(bpy.ops.pelagic, name) for name in dir(bpy.ops.pelagic))):
        if hasattr(each, "get_rna_type") or each.__name__.startswith("PELAGIC_"):
            rna = each.get_rna_type() if hasattr(each, "get_rna_type") else each.bl_rna
            said |= names(rna) | ({rna.name} if hasattr(each, "get_rna_type") else set())
    for path in (ROOT / "addon" / "pelagic_ocean").glob("*.py"):
        said |= set(re.findall(r'(?:text=|heading=|say\(|draw_words\(layout.box\(\), )"([^"]+)"', path.read_text(encoding="utf-8")))
    said |= {preset["label"] for preset in pelagic.presets() if preset["group"] == "beaufort"}
    missing = {text for text in said if translations.base(text)[0] not in {*translations.GERMAN, *SAME} and text not in translations.GERMAN}
    assert len(said) > 150 and not missing, missing
    tips = {properties._sentence(preset["help"]) for preset in pelagic.presets()}
    for each in (*bpy.types.PropertyGroup.__subclasses__(), *(getattr(bpy.ops.pelagic, name) for name in dir(bpy.ops.pelagic))):
        if hasattr(each, "get_rna_type") or each.__name__.startswith("PELAGIC_"):
            rna = each.get_rna_type() if hasattr(each, "get_rna_type") else each.bl_rna
            shown = [one for one in rna.properties if one.identifier not in ("name", "rna_type") and not one.identifier.startswith("bl_")]
            tips |= {one.description for one in shown} | {item.description for one in shown if one.type == "ENUM" for item in one.enum_items}
            tips |= {rna.description} if hasattr(each, "get_rna_type") else set()
    whole = translations._whole(translations.GERMAN)
    assert len(tips) > 250 and not tips - {*whole, *BLENDERS}, tips - {*whole, *BLENDERS}
    for text, german in translations.GERMAN.items():
        assert re.findall("{.*?}", text) == re.findall("{.*?}", german), text
    view = bpy.context.preferences.view
    before, view.language = view.language, next(each for each in ("de_DE", "de") if each in bpy.app.translations.locales)
    view.use_translate_interface = True
    spoken = {"Significant height": "Signifikante Wellenhöhe", "Wind direction (°)": "Windrichtung (°)", "Wind fetch": "Streichlänge"}
    for text, german in spoken.items():
        assert translations.say(text) == german, (text, translations.say(text))
    assert bpy.app.translations.pgettext_iface("Use Mesh as Ocean", "Operator") == "Netz als Ozean"
    assert bpy.app.translations.pgettext_iface("Wind fetch") == "Streichlänge"  # Blender has a fetch of something else
    for text in tips - BLENDERS:
        assert bpy.app.translations.pgettext_tip(text) != text, text
    assert translations.say("Viewport: {} of {} vertices", 1, 2) == "Ansicht: 1 von 2 Punkten"
    translations.unregister()
    assert [translations.say(text) for text in spoken] == [*spoken]
    translations.register()
    view.language = before

with checking("a tooltip says what a setting is, from where to where it goes and what each word of it means, without a shot file's words"):
    fields = [field for setting in properties.FIELDS for field in (setting, *properties.entry_fields(setting))]
    tips = {field.path: properties.tooltip(field.key) for field in fields}
    assert not [tip for tip in tips.values() if re.search(r'Accepted|_(?:m|s|deg|mps|px|file)\b|\b[a-z]+\.[a-z]+_|= "|shot file', tip)], tips
    assert tips["sea.wind_speed_mps"].endswith("0 to 80 m/s") and tips["shot.seed"].endswith(". 0 or more")
    assert tips["waves.lean_deg"].endswith("0 to 60°") and "Significant height" in properties._parts_of(properties.BY_PATH["sea.growth"].key)[1]["height-and-peak"]
    for field in fields:
        if field.key["type"] == "word":
            unsaid = {word for word in field.key["choices"] if word not in properties._parts_of(field.key)[1]}
            assert all(word.startswith("jerlov-") for word in unsaid), (field.path, unsaid)
            assert not any(f"{word}:" in tips[field.path] for word in field.key["choices"]), tips[field.path]

with checking("panels show what matters to the surface, and a unit once, beside its number"):
    obj.pelagic.uv_map = False
    shown = {kind: [field.name for field in properties.FIELDS if field.table == "surface" and panels._matters(field, obj.pelagic)]
             for kind in ("projected-grid", "patch") if not setattr(obj.pelagic.surface, "kind", kind)}
    assert not {"size_m", "resolution"} & set(shown["projected-grid"]) and "cell_px" in shown["projected-grid"], shown
    assert {"size_m", "resolution"} <= set(shown["patch"]) and "cell_px" not in shown["patch"], shown
    obj.pelagic.uv_map = True
    keys = [key for field in properties.FIELDS for key in (field.key, *(inner.key for inner in properties.entry_fields(field)))]
    assert {properties.unit_of(key) for key in keys if key["name"].endswith("_deg")} == {"°"}
    assert not [key["path"] for key in keys if key["unit"] and key["label"].lower().endswith((" km", " c", " deg"))]

with checking("one menu for quality: levels, and a budget that chooses the mesh"):
    quality, settings = obj.pelagic.quality, obj.pelagic
    kept = settings.viewport_percentage, settings.horizon
    settings.viewport_percentage, settings.horizon = 100, False
    items = [item.identifier for item in settings.bl_rna.properties["quality_menu"].enum_items]
    for word in items:
        settings.quality_menu = word
        assert settings.quality_menu == word, (settings.quality_menu, word)
        has_budget = ocean.scene_of(obj, scene).quality.max_error is not None
        assert has_budget == (word == properties.CUSTOM), word
    sides = []
    for error in (0.05, 0.02):
        settings.quality_menu, quality.max_error = properties.CUSTOM, error
        assert settle() is None, settle()
        side = ocean.scene_of(obj, scene).settled().surface.resolution
        assert len(obj.data.vertices) == (side + 1) ** 2, (len(obj.data.vertices), side)
        sides.append(side)
    assert sides[0] < sides[1], sides
    quality.max_error = 1e-6
    assert "raise the budget" in (settle() or ""), settle()
    settings.quality_menu = "final"
    assert settle() is None and ocean.scene_of(obj, scene).quality.max_error is None
    assert len(obj.data.vertices) == (settings.surface.resolution + 1) ** 2
    settings.viewport_percentage, settings.horizon = kept


def words_of(path):
    return list(properties.BY_PATH[path].key["choices"])


def kind(key, value):
    return int(value) if key["type"] == "integer" else value


with checking("the defaults are the core's"):
    fresh = ocean.scene_of(obj, scene)
    default = pelagic.Scene()
    for field in properties.FIELDS:
        if field.path == "surface.resolution":
            continue
        now, core = (getattr(getattr(each, field.table), field.name) for each in (fresh, default))
        assert now == core, f"{field.path}: {now!r}, {core!r}"

# A property that feeds none of these must be one that the sea takes: otherwise moving it would show nothing.
ONLY_SHOWN = {"name", "range", "clock", "view", "light", "water", "mesh", "maps", "spray", "volumes", "choice",
              "cage"}  # which is part of what identifies its surface
with checking("what feeds the sea makes another one"):
    for place, field in enumerate(properties.FIELDS):
        assert set(field.key["feeds"]) <= ONLY_SHOWN or place in play.SEA_FIELDS, field.path

with checking("every property at both ends"):
    obj.pelagic.effects.foam_decay_s = 0.5  # whose past is most of each sea's time
    tried, refusals = 0, []
    for field in properties.FIELDS:
        group = getattr(obj.pelagic, field.table)
        if field.key["type"] == "entries":
            continue
        before = getattr(group, field.name)
        other, (needed, *_) = properties.ONLY_WITH.get(field.path, ("waves.model", ("fft",)))
        if needed not in words_of(other):
            continue  # nobody can choose what it is for
        obj.pelagic.surface.cage_file = str(ROOT / "examples" / "pool.obj")
        change(obj, **{other.replace(".", "__"): needed})
        if field.switch:
            setattr(group, field.switch, True)
        for value in ends(field.key):
            setattr(group, field.name, kind(field.key, value))
            held = getattr(group, field.name)
            held = tuple(held) if field.key["type"] == "point" else held
            assert held == value or math.isclose(held, value, rel_tol=1e-6), f"{field.path}: {held!r}, not {value!r}"
            why = settle()
            tried += 1
            assert why is None or not field.key["of_picture"], why  # what is of a picture that isn't there counts for nothing
            if why is not None:
                assert field.name in why or "sea.spectrum" in why or "adaptive" in why, f"{field.path} = {value!r}: {why!r}"
                refusals.append(f"{field.path} = {value!r}: {why}")
        setattr(group, field.name, before)
        if field.switch:
            setattr(group, field.switch, False)
        change(obj, sea__spectrum="jonswap", waves__model="fft", surface__kind="patch")
        assert settle() is None, field.path
    print(f"{tried} values; refused:", *refusals, sep="\n  ")
    assert tried > 60

with checking("the entries of lists at both ends"):
    for field in properties.FIELDS:
        if field.key["type"] != "entries":
            continue
        rows = getattr(getattr(obj.pelagic, field.table), field.name)
        for key in field.key["keys"]:
            for value in ends(key):
                rows.clear()
                setattr(rows.add(), key["name"], kind(key, value))
                held = getattr(rows[0], key["name"])
                assert held == value or math.isclose(held, value, rel_tol=1e-6), key["path"]
                if key["path"] not in TOO_LARGE:
                    settle()
        rows.clear()
        obj.update_tag()
        assert settle() is None

with checking("gusts: hidden ripples and foam vary over the surface, and the waves that show stay"):
    obj.pelagic.viewport_percentage = 100
    change(obj, surface__resolution=64, surface__size_m=2000.0, sea__gust_size_m=300.0)
    calm, waves = numbers(obj.data, "slope_variance")[:, 0], numbers(obj.data)
    change(obj, sea__gust_strength=0.8)
    assert settle() is None
    gusty = numbers(obj.data, "slope_variance")[:, 0]
    print(f"    deviation of the slope variance, in means: {calm.std() / calm.mean():.3f}, with gusts {gusty.std() / gusty.mean():.3f}")
    assert gusty.std() > 2.0 * calm.std() and abs(gusty.mean() / calm.mean() - 1.0) < 0.1
    assert np.array_equal(numbers(obj.data), waves)
    foam = numbers(obj.data, "whitecap_coverage")
    strong, weak = (foam[gusty > np.quantile(gusty, 0.75)].mean(), foam[gusty < np.quantile(gusty, 0.25)].mean())
    print(f"    foam where gusts are strong: {strong:.4f}, where they are weak: {weak:.4f}")
    assert strong > 2.0 * weak

    def step():
        """From neighbour to neighbour, 31 m apart, which are the more alike the larger the patches."""
        return np.abs(np.diff(numbers(obj.data, "slope_variance")[:, 0].reshape(65, 65), axis=1)).mean()

    small = step()
    change(obj, sea__gust_size_m=3000.0)
    assert settle() is None and step() < 0.7 * small, (step(), small)
    change(obj, sea__gust_strength=0.0, sea__gust_size_m=300.0)
    assert np.array_equal(numbers(obj.data, "slope_variance")[:, 0], calm)
    obj.pelagic.viewport_percentage = 1

with checking("a wind of 0 is a flat sea"):
    change(obj, sea__wind_speed_mps=0.0)
    assert np.abs(numbers(obj.data)[:, 2]).max() < 1e-3
    scene.frame_set(7)
    assert np.isfinite(numbers(obj.data, "velocity")).all()

with checking("the settings of every example go in and come out the same"):
    examples = sorted((ROOT / "examples").glob("*.toml"))
    assert len(examples) > 5
    for path in examples:
        shot = pelagic.Scene.from_file(path)
        shot = shot.at(shot.shot.frames[0])  # Blender has no keys of numbers yet
        ocean.set_from(obj, shot)
        again = ocean.scene_of(obj, scene)
        for field in properties.FIELDS:
            now, was = (getattr(getattr(each, field.table), field.name) for each in (again, shot))
            if field.is_path and was and was != field.key["default"]:
                now, was = Path(now).resolve(), Path(was).resolve()
            assert now == was, f"{path.name}: {field.path}: {now!r}, {was!r}"
        assert again.sea.is_measured == shot.sea.is_measured

with checking("what Blender can't hold is refused before anything is changed"):
    shot = pelagic.Scene()
    shot.shot.seed, shot.sea.wind_speed_mps = 2**40, 3.0
    try:
        ocean.set_from(obj, shot)
        raise AssertionError("a seed of 2⁴⁰ was taken")
    except ValueError as error:
        assert "shot.seed" in str(error)
    assert obj.pelagic.sea.wind_speed_mps != 3.0
