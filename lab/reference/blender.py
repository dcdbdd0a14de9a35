"""blender.py: compares the reference path tracer with Blender's Cycles: five small scenes lit by meshes.

    blender -b --factory-startup --python-exit-code 1 -P lab/reference/blender.py -- MASU-BAKE MASU-LAB TABLE.csv

Writes each scene twice, as glTF for masu-bake and into Blender, renders both and compares the means of 144 patches.
Fails if a scene's mean, or the root mean square of its patches' errors, differs by more than 2 %. Both use the same
material model: Lambert, and metals whose microfacets have uncorrelated masking and scatter once (masu-lab reference
--cycles; Blender: Principled, metallic 1, distribution GGX). Written for Blender 3.4."""
import json, math, os, struct, subprocess, sys, tempfile, zlib
import bpy
import numpy as np
from mathutils import Matrix, Vector

BAKE, LAB, TABLE = sys.argv[sys.argv.index("--") + 1:]
WIDTH, HEIGHT, BOUNCES, PATHS, LIMIT = 128, 72, 24, 4096, 0.02

# ---- Scenes: objects (points, normals, coordinates of textures, triangles, material) ------------


def quad(a, b, c, d, material, repeat=1):
    p = np.array([a, b, c, d], float)
    n = np.cross(p[1] - p[0], p[2] - p[0])
    uv = np.array([[0, 1], [1, 1], [1, 0], [0, 0]], float) * repeat
    return p, np.tile(n / np.linalg.norm(n), (4, 1)), uv, np.array([[0, 1, 2], [0, 2, 3]]), material


def floor(size, material, y=0, repeat=1):
    return quad((-size, y, size), (size, y, size), (size, y, -size), (-size, y, -size), material, repeat)


def lamp(x, y, z, wide, deep, material):  # faces down
    return quad((x - wide, y, z - deep), (x + wide, y, z - deep), (x + wide, y, z + deep), (x - wide, y, z + deep),
                material)


def box(center, half, turn, material):
    faces = []
    c, s = math.cos(turn), math.sin(turn)
    spin = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    for axis in range(3):
        for side in (-1, 1):
            u, v, n = np.roll(np.eye(3), axis, 0) * np.array(half)
            p = [n * side + i * u * side + k * v for i, k in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
            faces.append(quad(*[spin @ q + center for q in p], material))
    return faces


def sphere(center, radius, material, rings=64):
    n, uv = [], []
    for i in range(rings + 1):
        for k in range(2 * rings + 1):
            polar, phi = math.pi * i / rings, math.pi * k / rings
            n.append((math.sin(polar) * math.cos(phi), math.cos(polar), math.sin(polar) * math.sin(phi)))
            uv.append((k / (2 * rings), i / rings))
    row, n = 2 * rings + 1, np.array(n)
    tris = [t for i in range(rings) for k in range(2 * rings) for t in
            (((i * row + k, i * row + k + 1, (i + 1) * row + k),) if i else ()) +
            (((i * row + k + 1, (i + 1) * row + k + 1, (i + 1) * row + k),) if i + 1 < rings else ())]
    return n * radius + center, n, np.array(uv), np.array(tris), material


def matt(color, **more):
    return dict(color=color, roughness=1, metallic=0, **more)


def metal(color, roughness, metallic=1, **more):
    return dict(color=color, roughness=roughness, metallic=metallic, **more)


def glow(*color):
    return dict(emission=color)


def room():
    grey, red, green = matt((.75, .75, .75)), matt((.63, .06, .05)), matt((.14, .45, .09))
    walls = [quad((-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1), "grey"),
             quad((-1, 2, -1), (1, 2, -1), (1, 2, 1), (-1, 2, 1), "grey"),
             quad((-1, 0, -1), (1, 0, -1), (1, 2, -1), (-1, 2, -1), "grey"),
             quad((-1, 0, 1), (-1, 0, -1), (-1, 2, -1), (-1, 2, 1), "red"),
             quad((1, 0, -1), (1, 0, 1), (1, 2, 1), (1, 2, -1), "green"), lamp(0, 1.98, 0, .3, .25, "lamp")]
    walls += box((-.35, .6, -.3), (.28, .6, .28), .3, "grey") + box((.4, .3, .3), (.28, .3, .28), -.3, "grey")
    return walls, dict(grey=grey, red=red, green=green, lamp=glow(17, 12, 5)), (0, 1, 3.9), (0, 1, 0), 39


def metals():
    rows = [metal(c, r) for c, r in (((.95, .93, .88), .2), ((1, .71, .29), .35), ((.95, .64, .54), .5),
                                     ((.5, .5, .5), .7), ((.9, .9, .9), 1))]
    objects = [sphere((1.1 * i - 2.2, .5, 0), .5, "m%d" % i) for i in range(5)]
    objects += [floor(6, "floor"), lamp(-2, 3, 1, 1, .5, "warm"), lamp(2.5, 2, -1, .5, .5, "cold")]
    return (objects, dict({"m%d" % i: m for i, m in enumerate(rows)}, floor=matt((.4, .4, .4)), warm=glow(9, 7, 5),
                          cold=glow(4, 7, 12)), (0, 1.6, 5.5), (0, .5, 0), 32)


def mixes():  # of a matt surface and a metal; lamps that are spheres
    rows = [metal(c, r, m) for c, r, m in (((.8, .2, .1), .25, .1), ((.2, .6, .3), .4, .3), ((.2, .3, .8), .6, .5),
                                           ((.8, .8, .8), .9, .7))]
    objects = [sphere((1.2 * i - 1.8, .5, 0), .5, "m%d" % i) for i in range(4)]
    objects += [floor(6, "floor"), sphere((-1.2, 1.8, 1), .25, "warm", 16), sphere((1.5, 1.2, 1.2), .15, "cold", 16)]
    return (objects, dict({"m%d" % i: m for i, m in enumerate(rows)}, floor=metal((.5, .45, .4), .5, .2),
                          warm=glow(30, 24, 16), cold=glow(30, 40, 60)), (0, 1.8, 5.5), (0, .5, 0), 32)


def pictures():  # colour, holes, and normals of a picture
    objects = [floor(5, "tiles", repeat=4), quad((-2, 0, 0), (0, 0, .5), (0, 1.8, .5), (-2, 1.8, 0), "holes"),
               quad((.2, .02, .8), (2.2, .02, .8), (2.2, .6, -1), (.2, .6, -1), "waves", 2),
               lamp(-1, 3, 1.5, .4, .4, "lamp"), lamp(2, 2.5, -1.5, 1, .5, "lamp")]
    return (objects, dict(tiles=matt((1, 1, 1), color_map="tiles"), lamp=glow(12, 11, 9),
                          holes=matt((.7, .6, .3), mask="holes"), waves=metal((.8, .7, .6), .4, normal_map="waves")),
            (0, 1.8, 5), (0, .7, 0), 36)


def panes():  # that hide half, and the shadows of them
    objects = [floor(5, "floor"), quad((-2, 0, .6), (-.2, 0, 1), (-.2, 1.6, 1), (-2, 1.6, .6), "pane"),
               quad((.3, 0, 1), (1.9, 0, .4), (1.9, 1.4, .4), (.3, 1.4, 1), "thin"),
               sphere((-.9, .5, -.3), .5, "ball"), sphere((1.1, .5, -.6), .5, "steel"),
               lamp(0, 3, 2.5, .6, .3, "lamp"), lamp(0, 2.5, -2, 1, .3, "lamp")]
    return (objects, dict(floor=matt((.6, .6, .6)), pane=matt((.8, .3, .2), opacity=.6),
                          thin=matt((.2, .4, .8), opacity=.3), ball=matt((.7, .7, .2)), steel=metal((.8, .8, .8), .3),
                          lamp=glow(10, 10, 9)), (0, 1.5, 5), (0, .6, 0), 36)


# ---- Pictures ------------------------------------------------------------------------------------


def png(path, rgba):
    high, wide, _ = rgba.shape
    rows = b"".join(b"\0" + r.tobytes() for r in np.clip(np.rint(rgba * 255), 0, 255).astype(np.uint8))
    chunk = lambda kind, data: (struct.pack(">I", len(data)) + kind + data +
                                struct.pack(">I", zlib.crc32(kind + data)))
    with open(path, "wb") as f:
        f.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", wide, high, 8, 6, 0, 0, 0)) +
                chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def write_pictures(folder):
    v, u = np.mgrid[0:128, 0:128] / 128 * 2 * np.pi
    one = np.ones_like(u)
    png(folder + "/tiles.png", np.stack([.6 + .2 * np.sin(u), .6 + .2 * np.cos(v), .5 + .2 * np.sin(u + v), one], 2))
    png(folder + "/holes.png", np.stack([one, one, one, .5 + .45 * np.cos(u) * np.cos(v)], 2))
    n = np.stack([.25 * np.sin(u), .25 * np.cos(2 * v), one], 2)  # height falls with -n.xy; +Y towards the top
    n /= np.linalg.norm(n, axis=2, keepdims=True)
    png(folder + "/waves.png", np.dstack([.5 + .5 * n, one]))


# ---- For masu-bake -------------------------------------------------------------------------------


def write_gltf(path, objects, materials):
    data, views, accessors, meshes, names = b"", [], [], [], list(materials)
    def add(values, kind, form):
        nonlocal data
        raw = np.ascontiguousarray(values, form).tobytes()
        views.append(dict(buffer=0, byteOffset=len(data), byteLength=len(raw)))
        data += raw
        entry = dict(bufferView=len(views) - 1, componentType=5126 if form == np.float32 else 5125, count=len(values),
                     type=kind)
        if kind == "VEC3": entry.update(min=np.min(values, 0).tolist(), max=np.max(values, 0).tolist())
        accessors.append(entry)
        return len(accessors) - 1
    for p, n, uv, tris, material in objects:
        a = dict(POSITION=add(p, "VEC3", np.float32), NORMAL=add(n, "VEC3", np.float32),
                 TEXCOORD_0=add(uv, "VEC2", np.float32))
        meshes.append(dict(primitives=[dict(attributes=a, indices=add(tris.ravel(), "SCALAR", np.uint32),
                                            material=names.index(material))]))
    with open(path + ".bin", "wb") as f: f.write(data)
    with open(path, "w") as f:
        json.dump(dict(asset=dict(version="2.0"), scene=0, scenes=[dict(nodes=list(range(len(meshes))))],
                       nodes=[dict(mesh=i) for i in range(len(meshes))], meshes=meshes,
                       materials=[dict(name=n, doubleSided=True) for n in names], accessors=accessors,
                       bufferViews=views, buffers=[dict(uri=os.path.basename(path) + ".bin", byteLength=len(data))]), f)


def material_json(name, m):
    if "emission" in m:
        return dict(match=name, base_color=[0, 0, 0], metallic=0, roughness=1, specular=0, emissive=m["emission"])
    out = dict(match=name, base_color=m["color"], roughness=m["roughness"], metallic=m["metallic"], specular=0)
    if "opacity" in m: out["opacity"] = m["opacity"]
    if "mask" in m: out.update(base_color_map=m["mask"] + ".png", alpha="mask", alpha_cutoff=.5)
    for kind in ("color", "normal"):
        if kind + "_map" in m: out[("base_color" if kind == "color" else kind) + "_map"] = m[kind + "_map"] + ".png"
    return out


def read_pfm(path):
    with open(path, "rb") as f:
        assert f.readline() == b"PF\n"
        wide, high = map(int, f.readline().split())
        order = "<" if float(f.readline()) < 0 else ">"
        return np.frombuffer(f.read(), order + "f4").reshape(high, wide, 3)[::-1].astype(float)


def ours(folder, objects, materials, eye, target, fov):
    scene = dict(models=[dict(file="scene.gltf", materials=[material_json(*m) for m in materials.items()])],
                 camera=dict(fov_y=fov, keys=[dict(position=eye, target=target)]), sun=dict(intensity=0),
                 ambient=[0, 0, 0], sky=dict(zenith=[0, 0, 0], horizon=[0, 0, 0]))
    write_gltf(folder + "/scene.gltf", objects, materials)
    with open(folder + "/scene.json", "w") as f: json.dump(scene, f)
    blob, image, error = (folder + "/scene" + e for e in (".masu", ".pfm", "_error.pfm"))
    subprocess.check_call([BAKE, folder + "/scene.json", "--bare", "-o", blob, "--quiet"])
    subprocess.check_call([LAB, "reference", blob, "-o", image, "--error", error, "--cycles", "--physics", "--size",
                           "%dx%d" % (WIDTH, HEIGHT), "--paths", str(PATHS), "--bounces", str(BOUNCES)])
    return read_pfm(image), read_pfm(error)


# ---- For Blender ---------------------------------------------------------------------------------


def nodes_of(name, m, folder):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    def node(kind, **values):
        n = nodes.new("ShaderNode" + kind)
        for key, value in values.items():
            if isinstance(value, bpy.types.NodeSocket): links.new(value, n.inputs[key])
            else: n.inputs[key].default_value = value
        return n
    def picture(file, space, extension="REPEAT"):
        n = nodes.new("ShaderNodeTexImage")
        n.image = bpy.data.images.load(folder + "/" + file + ".png", check_existing=True)
        n.image.colorspace_settings.name, n.interpolation, n.extension = space, "Linear", extension
        return n
    def mix(share, a, b):
        n = nodes.new("ShaderNodeMixShader")
        if isinstance(share, bpy.types.NodeSocket): links.new(share, n.inputs[0])
        else: n.inputs[0].default_value = share
        links.new(a.outputs[0], n.inputs[1])
        links.new(b.outputs[0], n.inputs[2])
        return n
    if "emission" in m:
        last = node("Emission", Color=(*m["emission"], 1), Strength=1)
    else:
        color, more = (*m["color"], 1), {}
        if "color_map" in m: color = picture(m["color_map"], "sRGB").outputs["Color"]
        if "normal_map" in m:
            more["Normal"] = node("NormalMap", Color=picture(m["normal_map"], "Non-Color").outputs["Color"]).outputs[0]
        last = node("BsdfDiffuse", Color=color, Roughness=0, **more)
        if m["metallic"] > 0:
            shine = node("BsdfPrincipled", Metallic=1, Roughness=m["roughness"], **{"Base Color": color}, **more)
            shine.distribution = "GGX"
            last = mix(m["metallic"], last, shine)
    through = None
    if "opacity" in m: through = m["opacity"]
    if "mask" in m:
        above = nodes.new("ShaderNodeMath")
        above.operation = "GREATER_THAN"
        links.new(picture(m["mask"], "sRGB", "EXTEND").outputs["Alpha"], above.inputs[0])
        above.inputs[1].default_value = .5
        through = above.outputs[0]
    if through is not None: last = mix(through, node("BsdfTransparent"), last)
    links.new(last.outputs[0], node("OutputMaterial").inputs["Surface"])
    return material


def cycles(folder, objects, materials, eye, target, fov):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    made = {name: nodes_of(name, m, folder) for name, m in materials.items()}
    for p, n, uv, tris, material in objects:
        mesh = bpy.data.meshes.new(material)
        mesh.from_pydata(p.tolist(), [], tris.tolist())
        mesh.uv_layers.new().data.foreach_set("uv", (uv * (1, -1) + (0, 1))[tris.ravel()].ravel())
        mesh.materials.append(made[material])
        mesh.use_auto_smooth = True
        mesh.polygons.foreach_set("use_smooth", [True] * len(tris))
        mesh.normals_split_custom_set_from_vertices(n.tolist())
        scene.collection.objects.link(bpy.data.objects.new(material, mesh))
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.sensor_fit = "VERTICAL"
    camera.data.angle = math.radians(fov)
    forward = (Vector(target) - Vector(eye)).normalized()
    right = forward.cross(Vector((0, 1, 0))).normalized()
    up = right.cross(forward)
    camera.matrix_world = Matrix((right, up, -forward)).transposed().to_4x4()
    camera.matrix_world.translation = Vector(eye)
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.world = bpy.data.worlds.new("black")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0
    scene.render.engine = "CYCLES"
    r, c = scene.render, scene.cycles
    r.resolution_x, r.resolution_y, r.resolution_percentage = WIDTH, HEIGHT, 100
    r.image_settings.file_format, r.image_settings.color_depth, r.filepath = "OPEN_EXR", "32", folder + "/cycles.exr"
    c.use_adaptive_sampling = c.use_denoising = False
    c.pixel_filter_type, c.blur_glossy, c.sample_clamp_direct, c.sample_clamp_indirect = "BOX", 0, 0, 0
    c.light_sampling_threshold, c.caustics_reflective = 0, True
    c.max_bounces = c.diffuse_bounces = c.glossy_bounces = BOUNCES
    c.transparent_max_bounces = 64
    c.samples = PATHS // 2
    halves = []
    for seed in range(2):
        c.seed = seed
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(r.filepath)
        image.colorspace_settings.name = "Non-Color"
        values = np.empty(4 * WIDTH * HEIGHT, np.float32)
        image.pixels.foreach_get(values)
        bpy.data.images.remove(image)
        halves.append(values.reshape(HEIGHT, WIDTH, 4)[::-1, :, :3].astype(float))
    return halves


# ---- Comparison ----------------------------------------------------------------------------------


def patches(image):
    return image.reshape(9, HEIGHT // 9, 16, WIDTH // 16, 3).mean((1, 3))


def compare(out, scene):
    with tempfile.TemporaryDirectory() as folder:
        write_pictures(folder)
        parts = scene()
        image, error = ours(folder, *parts)
        halves = cycles(folder, *parts)
    a, b, c = (patches(h) for h in (image, *halves))
    lit = b + c > .02 * (b + c).mean()
    b, c, a = b[lit], c[lit], a[lit]
    truth = (b + c) / 2
    off = a / truth - 1
    noise = math.sqrt(np.mean((.5 * (b - c) / truth) ** 2))
    own = math.sqrt(np.mean((np.sqrt(patches(error ** 2) / (WIDTH * HEIGHT / 144))[lit] / truth) ** 2))
    row = (a.sum() / truth.sum(), math.sqrt(np.mean(off ** 2)), np.percentile(abs(off), 95), abs(off).max(), own, noise)
    print(scene.__name__, lit.sum(), *("%.4f" % x for x in row), sep=",", file=out, flush=True)
    return abs(row[0] - 1) <= LIMIT and row[1] <= LIMIT


with open(TABLE, "w") as out:
    print("# make reference-blender: the reference over Blender %s, %dx%d, %d paths; 144 patches of three colours, "
          "those darker than 2 %% of the mean left out; noise: standard error of a patch, RMS" %
          (bpy.app.version_string, WIDTH, HEIGHT, PATHS), file=out)
    print("scene,patches,mean_ratio,rms_error,p95_error,worst_error,noise_reference,noise_blender", file=out)
    good = [compare(out, s) for s in (room, metals, mixes, pictures, panes)]
sys.exit(not all(good))
