// The part of read-stage.mjs that runs in the page, where OpenUSD lives: loads the layers, draws the stage at each
// time, and posts every array that OpenUSD hands over to the server, as raw bytes.
//
// Hydra hands over points, normals and the primvars of vectors. Primvars of plain floats, extent and the prims that
// this renderer does not draw are read from a second, slim stage: a layer over the root that blocks all that came
// through Hydra, flattened to text by OpenUSD.

async function postArray(header, array) {
    const query = new URLSearchParams(header);
    const answer = await fetch(`/array?${query}`, { method: 'POST', body: array });
    if (!answer.ok) throw new Error(`the server refused an array: ${answer.status}`);
}

// What a mesh has received so far. `fresh` holds what came since it was last cleared.
class MeshRecord {
    constructor() {
        this.fresh = new Map();
        this.primvars = {};
        this.material = null;
    }
    updatePoints(points) {
        this.fresh.set('points', points.slice());
    }
    updateIndices(indices) {
        this.fresh.set('indices', indices.slice());
    }
    // These would be smooth normals that Hydra computes; the layer's own normals come as a primvar.
    updateNormals() {}
    updatePrimvar(name, data, dimension, interpolation) {
        this.primvars[name] = { dimension, interpolation };
        this.fresh.set(name, data.slice());
    }
    setMaterial(path) {
        this.material = path;
    }
    setTransform(matrix) {
        this.fresh.set('transform', Float32Array.from(matrix));
    }
}

class Delegate {
    constructor() {
        this.meshes = new Map();
        this.materials = {};
    }
    createRPrim(type, path) {
        const record = new MeshRecord();
        if (type === 'mesh') this.meshes.set(path, record);
        return record;
    }
    createBPrim() {
        return {};
    }
    createSPrim(type, path) {
        return {
            updateNode: (network, node, parameters) => {
                const material = (this.materials[path] ??= {});
                material[node] = parameters;
            },
            updateFinished: () => {},
        };
    }
    CommitResources() {}
}

// A layer over the root in which the given attributes of each mesh have no value. It has the root's time codes per
// second, because OpenUSD scales a sublayer's times where they differ.
function slimLayer(rootFile, timeCodesPerSecond, blocked) {
    let text = `#usda 1.0\n(\n    timeCodesPerSecond = ${timeCodesPerSecond}\n` +
        `    subLayers = [@./${rootFile}@]\n)\n`;
    // A prim may be written once only: meshes are gathered into a tree.
    const tree = { attributes: [], children: new Map() };
    for (const [path, attributes] of blocked) {
        let prim = tree;
        for (const name of path.split('/').filter((word) => word !== '')) {
            if (!prim.children.has(name)) prim.children.set(name, { attributes: [], children: new Map() });
            prim = prim.children.get(name);
        }
        prim.attributes = attributes;
    }
    const write = ({ attributes, children }) => {
        for (const { type, name } of attributes) text += `${type} ${name} = None\n`;
        for (const [name, child] of children) {
            text += `over "${name}" {\n`;
            write(child);
            text += '}\n';
        }
    };
    write(tree);
    return text;
}

// The type with which an attribute is declared. It follows from OpenUSD's name for the type of its value, or from the
// attribute's name where several declared types have values of one type.
function declaredType(name, valueType) {
    const special = {
        points: 'point3f[]', normals: 'normal3f[]', velocities: 'vector3f[]', accelerations: 'vector3f[]',
        'primvars:st': 'texCoord2f[]', 'primvars:displayColor': 'color3f[]',
    };
    const general = {
        'VtArray<int>': 'int[]', 'VtArray<float>': 'float[]', 'VtArray<GfVec2f>': 'float2[]',
        'VtArray<GfVec3f>': 'float3[]', 'VtArray<GfVec4f>': 'float4[]',
    };
    return special[name] ?? general[valueType];
}

function numbersOf(text) {
    const numbers = text.replace(/[()[\]\s]/g, '').split(',').filter((word) => word !== '');
    return Float32Array.from(numbers, Number);
}

// The prims and the samples of float arrays and of files in the flattened text: the type of each prim by its path, the
// samples by prim, attribute and time. OpenUSD indents by four spaces a level, and writes files from the root on.
function parseFlattened(text, folder) {
    const prims = {};
    const samples = [];
    const files = {};
    const path = [];
    let attribute = null;
    for (const line of text.split('\n')) {
        const prim = /^( *)(?:def|over|class) (?:(\w+) )?"(\w+)"/.exec(line);
        if (prim) {
            path.length = prim[1].length / 4;
            path.push(prim[3]);
            prims[`/${path.join('/')}`] = prim[2] ?? '';
            continue;
        }
        const opening = /^ *(?:float\d?\[\]|asset) ([\w:]+)\.timeSamples = \{$/.exec(line);
        if (opening) {
            attribute = opening[1];
            continue;
        }
        if (attribute === null) continue;
        if (/^ *\}$/.test(line)) {
            attribute = null;
            continue;
        }
        const sample = /^ *([-+.\deE]+): (\[.*\]),$/.exec(line);
        if (sample) {
            samples.push({ prim: `/${path.join('/')}`, attribute, time: Number(sample[1]), text: sample[2] });
        }
        const file = /^ *([-+.\deE]+): @(.*)@,$/.exec(line);
        if (file) {
            const named = (files[`/${path.join('/')}.${attribute}`] ??= {});
            named[Number(file[1])] = file[2].startsWith(`${folder}/`) ? file[2].slice(folder.length + 1) : file[2];
        }
    }
    return { prims, samples, files };
}

// Where two layers differ when OpenUSD writes each as text, a line for each pair that does.
function differencesOfLayers(usd, folder, pairs) {
    const linesOf = (file) =>
        usd.UsdStage.Open(`${folder}/${file}`).GetRootLayer().ExportToString().split('\n');
    return pairs.flatMap(([one, other]) => {
        const lines = linesOf(one);
        const others = linesOf(other);
        const at = Array.from({ length: Math.max(lines.length, others.length) }, (_, i) => i)
            .find((i) => lines[i] !== others[i]);
        if (at === undefined) return [];
        const shown = (line) => JSON.stringify(line?.slice(0, 200));
        return [`${one}: line ${at + 1} is ${shown(lines[at])}, and in ${other} ${shown(others[at])}`];
    });
}

// Called by read-stage.mjs. Returns all that was read except the arrays.
async function readStage({ rootFile, layers, frames, pairs }) { // eslint-disable-line no-unused-vars
    const folder = '/stage';
    const usd = await getUsdModule(undefined, '/openusd');
    usd.FS.mkdirTree(folder);
    for (const layer of layers) {
        const answer = await fetch(`/layer?${new URLSearchParams({ file: layer })}`);
        if (!answer.ok) throw new Error(`the server does not give ${layer}: ${answer.status}`);
        const slash = layer.lastIndexOf('/');
        const parent = slash < 0 ? folder : `${folder}/${layer.slice(0, slash)}`;
        usd.FS.mkdirTree(parent);
        usd.FS.createDataFile(parent, layer.slice(slash + 1), new Uint8Array(await answer.arrayBuffer()), true,
            true, true);
    }

    const delegate = new Delegate();
    const started = performance.now();
    const driver = new usd.HdWebSyncDriver(delegate, `${folder}/${rootFile}`);
    const openMs = performance.now() - started;
    for (const frame of frames) {
        driver.SetTime(frame);
        driver.Draw();
        for (const [prim, record] of delegate.meshes) {
            for (const [name, array] of record.fresh) {
                const type = array instanceof Int32Array ? 'int32' : 'float32';
                await postArray({ frame, prim, name, type }, array);
            }
            record.fresh.clear();
        }
    }

    const stage = driver.GetStage();
    const blocked = new Map();
    const wanted = new Map();
    for (const [path, record] of delegate.meshes) {
        const prim = stage.GetPrimAtPath(path);
        const attributes = [];
        const names = new Set();
        for (const name of prim.GetPropertyNames()) {
            const short = name.replace(/^primvars:/, '');
            const handedOver = short in record.primvars || /^faceVertex(Counts|Indices)$/.test(name);
            const type = declaredType(name, handedOver ? prim.GetAttribute(name).GetTypeName() : '');
            if (handedOver && type) attributes.push({ type, name });
            if (!handedOver && (name === 'extent' || name.startsWith('primvars:'))) names.add(name);
        }
        blocked.set(path, attributes);
        wanted.set(path, names);
    }
    // In the root's own folder, so that relative paths stay what they are.
    const slim = rootFile.replace(/[^/]*$/, 'read-stage-slim.usda');
    const slimFolder = `${folder}/${slim}`.replace(/\/[^/]*$/, '');
    usd.FS.createDataFile(slimFolder, 'read-stage-slim.usda',
        new TextEncoder().encode(
            slimLayer(rootFile.replace(/^.*\//, ''), stage.GetTimeCodesPerSecond(), blocked)), true, true, true);
    const flattened = usd.UsdStage.Open(`${folder}/${slim}`).ExportToString();
    const { prims, samples, files } = parseFlattened(flattened, folder);
    for (const { prim, attribute, time, text } of samples) {
        if (!wanted.get(prim)?.has(attribute) || !frames.includes(time)) continue;
        const name = attribute.replace(/^primvars:/, '');
        await postArray({ frame: time, prim, name, type: 'float32' }, numbersOf(text));
    }

    return {
        openMs,
        layerDifferences: differencesOfLayers(usd, folder, pairs),
        rootLayer: stage.GetRootLayer().ExportToString(),
        flattened,
        prims,
        files,
        stage: {
            startTimeCode: stage.GetStartTimeCode(),
            endTimeCode: stage.GetEndTimeCode(),
            timeCodesPerSecond: stage.GetTimeCodesPerSecond(),
        },
        materials: delegate.materials,
        meshes: Object.fromEntries([...delegate.meshes].map(([path, record]) =>
            [path, { material: record.material, primvars: record.primvars }])),
    };
}
