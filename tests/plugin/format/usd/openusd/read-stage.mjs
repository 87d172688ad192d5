#!/usr/bin/env node
// Reads a USD stage with OpenUSD (version 22 as WebAssembly, from the package three-usdz-loader) in headless Chromium,
// and says what it complains about and what numbers it hands over at each frame. See --help.
import fs from 'node:fs';
import http from 'node:http';
import path from 'node:path';
import { fileURLToPath } from 'node:url';

const help = `Usage: read-stage.mjs DIR ROOT FRAME… [options]

Opens DIR/ROOT with OpenUSD, sets the time to each FRAME (also between two frames: 1.5) in the order given, draws, and
collects what OpenUSD hands over. All layers below DIR (.usda .usdc .usd) are given to it.

  --json FILE        write all that was read (below)
  --expect FILE      compare with FILE, of the same form: every array, prim, mesh and stage value that it names must
                     have been read with exactly the same float32 values, and every transform within 2e-7; the
                     time samples of every attribute in "files" must be the same, and each file be there, not empty;
                     "flattened" and "root" list lines that must
                     stand in the flattened stage, and in the root layer as OpenUSD writes it again (spaces at
                     either end aside); "sameLayers" lists pairs of layers, [A, B], that must be the same when
                     OpenUSD opens each and writes it as text
  --binary FOLDER    write the arrays into FOLDER, little-endian, and { "file", "type", "count" } into the JSON
                     instead of the values; --expect reads such entries too, relative to its own place
  --flatten FILE     write the composed stage as OpenUSD flattens it, without the arrays that Hydra handed over
  --only-requested   give OpenUSD only the frame layers (NAME.NUMBER.usd?) of the frames asked for: for long shots
  --timeout SECONDS  give up after so long (300)
  --chromium FILE    the browser (CHROMIUM, else /usr/bin/chromium)
  --help

JSON:
  { "complaints": [line…], "known": [line…], "open_ms": n,
    "stage": { startTimeCode, endTimeCode, timeCodesPerSecond },
    "prims": { PATH: TYPE… },
    "files": { PATH.ATTRIBUTE: { FRAME: file below DIR… } },
    "meshes": { PATH: { "material": PATH, "indices": array, "primvars": { NAME: { dimension, interpolation } } } },
    "materials": { PATH: { NODE: { parameter: value } } },
    "frames": { FRAME: { PATH: { "points": array, "normals": array, "velocities": array, "indices": array,
                                 "transform": [16 numbers, as USD writes a matrix], NAME: array… } } } }
Primvars stand under their names without "primvars:". Indices are those of triangles. Primvars of plain floats, and
extent, are there only at frames that have a time sample of their own; everything else is there at every frame.

Exit status: 0 all well; 1 OpenUSD complained, or something is not as expected; 2 wrong arguments; 3 could not run
(no browser, not installed, out of time). Install once with install.sh.`;

// OpenUSD's complaints about this build of itself, the same for any stage; every other line is about the stage. Its
// renderer draws meshes only, and complains about every light and camera and about the primvars of a cage. The build
// lacks the plugin with which the shader registry finds shaders, and the first material makes it complain.
const known = [
    // From Emscripten's runtime, about OpenUSD's threads, when the machine is slow.
    /^Blocking on the main thread is very dangerous, see https:\/\/emscripten\.org\/\S+$/,
    /Failed to find plugin for schema type 'UsdVol(OpenVDBAsset|Volume|Field3DAsset)'$/,
    /Selected hydra renderer doesn't support prim type '(DistantLight|LightAPI|DomeLight|Camera)'$/,
    /webRenderDelegate\.cpp -- Unsupported interpolation type 'varying' for primvar \w+$/,
    /^Coding Error: in _FindAndInstantiateDiscoveryPlugins .*Failed verification: ' pluginFactory '$/,
];

const here = path.dirname(fileURLToPath(import.meta.url));
const external = path.join(here, 'node_modules', 'three-usdz-loader', 'external');

class UsageError extends Error {}
class CannotRun extends Error {}

function parseArguments(words) {
    const options = {
        frames: [], json: null, expect: null, binary: null, flatten: null, onlyRequested: false, timeoutS: 300,
        chromium: process.env.CHROMIUM ?? '/usr/bin/chromium',
    };
    const valued = { '--json': 'json', '--expect': 'expect', '--binary': 'binary', '--flatten': 'flatten',
        '--timeout': 'timeoutS', '--chromium': 'chromium' };
    const places = [];
    for (let i = 0; i < words.length; ++i) {
        const word = words[i];
        if (word === '--help' || word === '-h') {
            console.log(help);
            process.exit(0);
        } else if (word === '--only-requested') {
            options.onlyRequested = true;
        } else if (word in valued) {
            if (i + 1 >= words.length) throw new UsageError(`${word} needs a value`);
            options[valued[word]] = words[++i];
        } else if (word.startsWith('--')) {
            throw new UsageError(`unknown option ${word}`);
        } else if (places.length < 2) {
            places.push(word);
        } else if (/^-?\d+(\.\d+)?$/.test(word)) {
            options.frames.push(Number(word));
        } else {
            throw new UsageError(`a frame is a number, not ${word}`);
        }
    }
    options.timeoutS = Number(options.timeoutS);
    if (!(options.timeoutS > 0)) throw new UsageError('--timeout needs a number of seconds above 0');
    if (places.length < 2 || options.frames.length === 0) throw new UsageError('DIR, ROOT and a frame are needed');
    [options.dir, options.root] = places;
    if (!fs.existsSync(path.join(options.dir, options.root))) {
        throw new UsageError(`there is no ${path.join(options.dir, options.root)}`);
    }
    return options;
}

function layersOf(options) {
    const requested = new Set(options.frames);
    return fs.readdirSync(options.dir, { recursive: true })
        .map((file) => file.split(path.sep).join('/'))
        .filter((file) => /\.usd[ac]?$/.test(file))
        .filter((file) => {
            const frame = /\.(-?\d+)\.usd[ac]?$/.exec(file);
            return !options.onlyRequested || !frame || requested.has(Number(frame[1]));
        });
}

// Arrays by frame, prim and name, as they come from the page.
class Arrays {
    constructor() {
        this.frames = new Map();
        this.indices = new Map();
    }
    add({ frame, prim, name, type }, bytes) {
        const copy = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
        if (name === 'indices') this.indices.set(prim, new Int32Array(copy));
        const prims = this.frames.get(Number(frame)) ?? new Map();
        const arrays = prims.get(prim) ?? new Map();
        arrays.set(name, type === 'int32' ? new Int32Array(copy) : new Float32Array(copy));
        prims.set(prim, arrays);
        this.frames.set(Number(frame), prims);
    }
    // Hydra hands over only what has changed since the frame drawn before; this fills in the rest.
    carryForward(frames, drawn) {
        const latest = new Map();
        for (const frame of frames) {
            const prims = this.frames.get(frame) ?? new Map();
            for (const [prim, names] of drawn) {
                const arrays = prims.get(prim) ?? new Map();
                for (const name of names) {
                    const key = `${prim} ${name}`;
                    if (arrays.has(name)) latest.set(key, arrays.get(name));
                    else if (latest.has(key)) arrays.set(name, latest.get(key));
                }
                prims.set(prim, arrays);
            }
            this.frames.set(frame, prims);
        }
    }
}

// SharedArrayBuffer, which OpenUSD's threads need, is only given to pages that are isolated by these two headers.
const isolation = {
    'Cross-Origin-Opener-Policy': 'same-origin',
    'Cross-Origin-Embedder-Policy': 'require-corp',
    'Cache-Control': 'no-store',
};
const contentTypes = { '.html': 'text/html', '.js': 'text/javascript', '.wasm': 'application/wasm' };

function startServer(options, layers, arrays) {
    const files = new Map([['/', path.join(here, 'page.html')], ['/page.js', path.join(here, 'page.js')]]);
    for (const file of fs.readdirSync(external)) files.set(`/openusd/${file}`, path.join(external, file));
    const allowed = new Set(layers);

    const server = http.createServer((request, response) => {
        const url = new URL(request.url, 'http://127.0.0.1');
        const query = Object.fromEntries(url.searchParams);
        if (request.method === 'POST' && url.pathname === '/array') {
            const parts = [];
            request.on('data', (part) => parts.push(part));
            request.on('end', () => {
                arrays.add(query, Buffer.concat(parts));
                response.writeHead(204, isolation).end();
            });
            return;
        }
        const file = url.pathname === '/layer' && allowed.has(query.file)
            ? path.join(options.dir, query.file) : files.get(url.pathname);
        if (!file) {
            response.writeHead(404, isolation).end();
            return;
        }
        const type = contentTypes[path.extname(file)] ?? 'application/octet-stream';
        response.writeHead(200, { ...isolation, 'Content-Type': type });
        fs.createReadStream(file).on('error', () => response.destroy()).pipe(response);
    });
    return new Promise((resolve, reject) => {
        server.on('error', reject);
        server.listen(0, '127.0.0.1', () => resolve(server));
    });
}

async function launchBrowser(options) {
    let playwright;
    try {
        playwright = await import('playwright-core');
        fs.accessSync(external);
    } catch {
        throw new CannotRun(`not installed; run ${path.join(here, 'install.sh')}`);
    }
    try {
        // A profile of its own is made and removed by launch(). No sandbox: it does not start as root, and the page
        // is ours.
        return await playwright.chromium.launch({
            executablePath: options.chromium,
            args: ['--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run',
                '--disable-background-networking', '--disable-component-update', '--disable-sync'],
        });
    } catch (error) {
        throw new CannotRun(`${options.chromium} does not start (apt-get install chromium): ` +
            error.message.split('\n')[0]);
    }
}

async function read(options, pairs) {
    const arrays = new Arrays();
    const lines = [];
    const browser = await launchBrowser(options);
    let server;
    let timer;
    try {
        const layers = layersOf(options);
        server = await startServer(options, layers, arrays);
        const page = await browser.newPage();
        page.on('console', (message) => lines.push(...message.text().split('\n').filter((line) => line !== '')));
        page.on('pageerror', (error) => lines.push(`page: ${error.message}`));
        const work = async () => {
            await page.goto(`http://127.0.0.1:${server.address().port}/`);
            return page.evaluate((task) => readStage(task), // eslint-disable-line no-undef
                { rootFile: options.root, layers, frames: options.frames, pairs });
        };
        const outOfTime = new Promise((_, reject) => {
            timer = setTimeout(() => reject(new CannotRun(`not done after ${options.timeoutS} s`)),
                options.timeoutS * 1000);
        });
        const crashed = new Promise((_, reject) => {
            page.on('crash', () => reject(new CannotRun('the page crashed, probably out of memory')));
        });
        let result = {};
        try {
            result = await Promise.race([work(), outOfTime, crashed]);
        } catch (error) {
            if (error instanceof CannotRun) throw error;
            // An exception of OpenUSD's arrives as a bare number.
            lines.push(`broke off: ${error.message.split('\n')[0]}`);
        }
        const drawn = Object.entries(result.meshes ?? {})
            .map(([prim, mesh]) => [prim, ['points', 'indices', 'transform', ...Object.keys(mesh.primvars)]]);
        arrays.carryForward(options.frames, drawn);
        return { lines, arrays, result };
    } finally {
        clearTimeout(timer);
        await browser.close();
        server?.closeAllConnections();
        server?.close();
    }
}

function writeJson(options, { complaints, knownLines, arrays, result }) {
    if (options.binary) fs.mkdirSync(options.binary, { recursive: true });
    const out = fs.openSync(options.json, 'w');
    const put = (text) => fs.writeSync(out, text);
    const putArray = (array, label) => {
        if (options.binary) {
            const file = path.join(options.binary, `${label.replace(/[^\w.-]/g, '_')}.bin`);
            fs.writeFileSync(file, Buffer.from(array.buffer));
            const type = array instanceof Int32Array ? 'int32' : 'float32';
            put(JSON.stringify({ file: path.relative(path.dirname(path.resolve(options.json)), path.resolve(file)),
                type, count: array.length }));
            return;
        }
        // In pieces: a whole frame may be longer than a string may be. JSON.stringify forgets the sign of −0.
        put('[');
        for (let i = 0; i < array.length; i += 65536) {
            const piece = Array.from(array.subarray(i, i + 65536),
                (x) => (Object.is(x, -0) ? '-0' : Number.isFinite(x) ? String(x) : 'null'));
            put((i > 0 ? ',' : '') + piece.join(','));
        }
        put(']');
    };
    const putObject = (entries, putValue) => {
        put('{');
        let separator = '\n';
        for (const [key, value] of entries) {
            put(`${separator}${JSON.stringify(String(key))}: `);
            putValue(value, key);
            separator = ',\n';
        }
        put('}');
    };
    const putPlain = (value) => put(JSON.stringify(value ?? null));
    putObject([
        ['complaints', () => putPlain(complaints)],
        ['known', () => putPlain(knownLines)],
        ['open_ms', () => putPlain(result.openMs)],
        ['stage', () => putPlain(result.stage)],
        ['prims', () => putPlain(result.prims)],
        ['files', () => putPlain(result.files)],
        ['materials', () => putPlain(result.materials)],
        ['meshes', () => putObject(Object.entries(result.meshes ?? {}), (mesh, prim) => putObject([
            ['material', () => putPlain(mesh.material)],
            ['primvars', () => putPlain(mesh.primvars)],
            ['indices', () => putArray(arrays.indices.get(prim) ?? new Int32Array(0), `${prim}.indices`)],
        ], (write) => write()))],
        ['frames', () => putObject(arrays.frames, (prims, frame) => putObject(prims, (named, prim) =>
            putObject(named, (array, name) => putArray(array, `${frame}.${prim}.${name}`))))],
    ], (write) => write());
    put('\n');
    fs.closeSync(out);
}

// What differs from the expected values, a line each.
function differences(options, expected, arrays, result) {
    const found = [];
    const load = (entry, Type) => {
        if (Array.isArray(entry)) return Type.from(entry);
        const bytes = fs.readFileSync(path.join(path.dirname(options.expect), entry.file));
        return new Type(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength));
    };
    const compareArrays = (what, entry, got, Type) => {
        if (!got) {
            found.push(`${what}: not handed over`);
            return;
        }
        const wanted = load(entry, Type);
        if (wanted.length !== got.length) {
            found.push(`${what}: ${got.length} values instead of ${wanted.length}`);
            return;
        }
        const wrong = wanted.findIndex((value, i) => !Object.is(value, got[i]));
        if (wrong >= 0) found.push(`${what}[${wrong}]: ${got[wrong]} instead of ${wanted[wrong]}`);
    };
    // OpenUSD computes them in double precision out of angles and translations, and hands them over as floats.
    const compareTransforms = (what, wanted, got) => {
        const near = (value, i) => Math.abs(value - got[i]) <= 2e-7 * Math.max(1, Math.abs(value));
        if (!got) found.push(`${what}: not handed over`);
        else if (wanted.length !== got.length || !wanted.every(near)) {
            found.push(`${what}: ${got} instead of ${wanted}`);
        }
    };
    const comparePlain = (what, wanted, got) => {
        if (wanted !== null && typeof wanted === 'object') {
            for (const key of Object.keys(wanted)) comparePlain(`${what} ${key}`, wanted[key], got?.[key]);
        } else if (wanted !== got) {
            found.push(`${what}: ${JSON.stringify(got)} instead of ${JSON.stringify(wanted)}`);
        }
    };
    comparePlain('stage', expected.stage ?? {}, result.stage);
    comparePlain('prims', expected.prims ?? {}, result.prims);
    comparePlain('materials', expected.materials ?? {}, result.materials);
    comparePlain('files', expected.files ?? {}, result.files);
    for (const [attribute, wanted] of Object.entries(expected.files ?? {})) {
        const samples = Object.entries(result.files?.[attribute] ?? {});
        for (const [frame, file] of samples) {
            if (!(frame in wanted)) found.push(`files ${attribute} ${frame}: ${file} instead of none`);
            const place = path.join(options.dir, file);
            if (!fs.existsSync(place) || fs.statSync(place).size === 0) found.push(`${place} is missing or empty`);
        }
    }
    for (const [prim, { indices, ...rest }] of Object.entries(expected.meshes ?? {})) {
        comparePlain(`meshes ${prim}`, rest, result.meshes?.[prim]);
        if (indices) compareArrays(`${prim} indices`, indices, arrays.indices.get(prim), Int32Array);
    }
    for (const [frame, prims] of Object.entries(expected.frames ?? {})) {
        for (const [prim, named] of Object.entries(prims)) {
            for (const [name, entry] of Object.entries(named)) {
                const got = arrays.frames.get(Number(frame))?.get(prim)?.get(name);
                const what = `frame ${frame} ${prim} ${name}`;
                if (name === 'transform') compareTransforms(what, entry, got);
                else compareArrays(what, entry, got, name === 'indices' ? Int32Array : Float32Array);
            }
        }
    }
    const compareLines = (what, wanted, text) => {
        const lines = new Set((text ?? '').split('\n').map((line) => line.trim()));
        for (const line of wanted ?? []) {
            if (!lines.has(line.trim())) found.push(`not in the ${what}: ${line.trim()}`);
        }
    };
    compareLines('flattened stage', expected.flattened, result.flattened);
    compareLines('root layer', expected.root, result.rootLayer);
    for (const difference of result.layerDifferences ?? []) found.push(difference);
    return found;
}

async function main() {
    const options = parseArguments(process.argv.slice(2));
    const expected = options.expect ? JSON.parse(fs.readFileSync(options.expect, 'utf8')) : {};
    const { lines, arrays, result } = await read(options, expected.sameLayers ?? []);
    const isKnown = (line) => known.some((pattern) => pattern.test(line));
    const complaints = lines.filter((line) => !isKnown(line));
    for (const line of complaints) console.error(`OpenUSD: ${line}`);
    if (options.json) writeJson(options, { complaints, knownLines: lines.filter(isKnown), arrays, result });
    if (options.flatten) fs.writeFileSync(options.flatten, result.flattened ?? '');
    const found = options.expect ? differences(options, expected, arrays, result) : [];
    for (const line of found) console.error(`differs: ${line}`);
    console.log(`${options.frames.length} frames, ${Object.keys(result.meshes ?? {}).length} meshes, ` +
        `${Object.keys(result.prims ?? {}).length} prims; ${complaints.length} complaints` +
        (options.expect ? `, ${found.length} differences` : ''));
    return complaints.length + found.length > 0 ? 1 : 0;
}

try {
    process.exitCode = await main();
} catch (error) {
    console.error(`read-stage: ${error.message}`);
    if (error instanceof UsageError) console.error('read-stage.mjs --help says more');
    process.exitCode = error instanceof UsageError ? 2 : 3;
}
