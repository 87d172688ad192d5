"""A mesh of the file as the cage of a sea: its creases, its changes, what is refused."""

import sys
import tempfile
from pathlib import Path

from mathutils.kdtree import KDTree

sys.path.insert(0, str(Path(__file__).parent))
from harness import *  # noqa: F403

enable()
from pelagic_ocean import baked, ocean, play

folder = Path(tempfile.mkdtemp())


def hilly(size_m=80.0, side=4):
    """A grid with a hill, half creased edges and a sharp one."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=side, y_subdivisions=side, size=size_m)
    obj = bpy.context.object
    mesh = obj.data
    mesh.vertices[12].co.z, mesh.vertices[7].co.z = 20.0, -5.0
    for edge in mesh.edges:
        ends = set(edge.vertices)
        edge.crease = 1.0 if ends == {11, 12} else 0.5 if 12 in ends or 7 in ends else 0.0
    return obj


def sea_on(cage):
    bpy.context.view_layer.objects.active = cage
    assert bpy.ops.pelagic.use_cage() == {"FINISHED"}
    return bpy.context.object


def farthest(points, others):
    """Of each point from the nearest of the others."""
    tree = KDTree(len(others))
    for index, other in enumerate(others):
        tree.insert(other, index)
    tree.balance()
    return max(tree.find(point)[2] for point in points)


with checking("a calm sea lies on the surface that Blender's own subdivision comes to, creases included"):
    fresh_file()
    cage = hilly()
    sea = sea_on(cage)
    change(sea, sea__wind_speed_mps=0.0, surface__cage_level=3)
    assert not play.simulation_of(sea).problem, play.simulation_of(sea).problem
    ours = numbers(sea.data)
    smooth = cage.copy()
    smooth.data = cage.data.copy()
    bpy.context.collection.objects.link(smooth)
    modifier = smooth.modifiers.new("Smooth", "SUBSURF")
    modifier.levels, modifier.quality, modifier.boundary_smooth = 3, 8, "PRESERVE_CORNERS"
    theirs = numbers(evaluated_mesh(smooth))
    assert len(ours) == len(theirs) == 33**2
    apart = farthest(ours, theirs)
    for edge in smooth.data.edges:
        edge.crease = edge.crease**0.5  # what a sharpness of ten times the crease would be
    smooth.data.update()
    bpy.context.view_layer.update()
    other = farthest(ours, numbers(evaluated_mesh(smooth)))
    print(f"    from Blender's surface: {1e3 * apart:.2f} mm, from one of other creases {1e3 * other:.0f} mm")
    assert apart < 0.01 < 0.1 < other
    bpy.data.objects.remove(smooth)

with checking("waves are on top of it, and the sea follows when the cage changes or moves"):
    change(sea, sea__wind_speed_mps=15.0)
    wavy = numbers(sea.data)
    assert 0.2 < (wavy - ours)[:, 2].std() < 3.0 and wavy[:, 2].max() > 8.0
    cage.data.vertices[12].co.z = 0.0
    cage.data.update()
    bpy.context.view_layer.update()
    assert numbers(sea.data)[:, 2].max() < wavy[:, 2].max() - 3.0
    cage.location.z = 30.0
    bpy.context.view_layer.update()
    assert numbers(sea.data)[:, 2].min() > 15.0
    cage.location.z = 0.0

with checking("modifiers of the cage count; one that subdivides is refused in words"):
    waves = cage.modifiers.new("Lift", "DISPLACE")
    waves.strength, waves.direction = 10.0, "Z"
    waves.mid_level = 0.0
    bpy.context.view_layer.update()
    lifted = numbers(sea.data)[:, 2].mean()
    assert lifted > 5.0, lifted
    cage.modifiers.remove(waves)
    smooth = cage.modifiers.new("Smooth", "SUBSURF")
    bpy.context.view_layer.update()
    assert "subdivide it twice" in play.simulation_of(sea).problem
    cage.modifiers.remove(smooth)
    bpy.context.view_layer.update()
    assert not play.simulation_of(sea).problem

with checking("baked as it is, and played; a shot file can't name it"):
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, 2
    bpy.context.scene.frame_set(2)
    sea.pelagic_bake.folder = str(folder)
    bpy.context.view_layer.objects.active = sea
    assert bpy.ops.pelagic.bake() == {"FINISHED"}
    live = numbers(sea.data)
    assert bpy.ops.pelagic.play_bake(filepath=str(folder / ocean.clean_name(sea.name))) == {"FINISHED"}
    played = bpy.context.object
    # A bake's footprints are powers of two, the live sea's begin at its smallest cell: the shortest waves differ a little.
    apart = np.abs(numbers(played.data) - live)
    print(f"    the bake is {apart.mean():.3f} m from the live sea, at most {apart.max():.3f} m")
    assert not baked.problems and apart.max() < 0.1 and apart.mean() < 0.02
    bpy.context.view_layer.objects.active = sea
    assert refused(lambda: bpy.ops.pelagic.export_shot(filepath=str(folder / "x.toml")), "came from no file")

with checking("what is no cage is refused, and nothing is added"):
    mesh = bpy.data.meshes.new("Book")  # three faces round an edge
    mesh.from_pydata([(0, 0, 0), (0, 9, 0), (9, 0, 0), (-9, 0, 0), (0, 0, 9)], [], [(0, 2, 1), (0, 1, 3), (1, 0, 4)])
    book = bpy.data.objects.new("Book", mesh)
    bpy.context.collection.objects.link(book)
    bpy.context.view_layer.objects.active = book
    count = len(bpy.data.objects)
    assert refused(bpy.ops.pelagic.use_cage, "Book")
    assert len(bpy.data.objects) == count

with checking("without a cage the sea says what it needs"):
    sea.pelagic.cage = None
    bpy.context.view_layer.update()
    assert "cage_file" in play.simulation_of(sea).problem
