#!/usr/bin/env node
// Reads crates with three.js's USDCParser, and compares each with its twin in text, which is read here. See --help.
import fs from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';

const help = `Usage: read-crates.mjs DIR [--large FILE]

Reads each NAME.usdc below DIR and its twin NAME.usda, in the form in which Pelagic writes it, and compares the prim,
the attributes with their types, variability, interpolation and times, and every number of every array, bit for bit.
three.js leaves out what stands in dictionaries, and so does this. A NAME.camera.usdc is compared with NAME.camera.json
instead: the lens, the frames that have samples, and the matrix (camera to world) at each.

  --large FILE   read one more crate, of 2049² vertices, in whose points and coverage value i is i
  --help

Exit status: 0 all well; 1 something differs; 2 wrong arguments; 3 could not run (not installed). Install once with
install.sh.`;

const here = path.dirname(fileURLToPath(import.meta.url));

async function loadParser() {
    try {
        return (await import('three/examples/jsm/loaders/usd/USDCParser.js')).USDCParser;
    } catch {
        console.error(`read-crates: not installed; run ${path.join(here, 'install.sh')}`);
        process.exit(3);
    }
}

// Numbers of the format: Specifier and Variability.
const specifiers = ['def', 'over', 'class'];
const variabilities = ['', 'uniform '];

function scalarOf(text) {
    if (text.startsWith('"')) return JSON.parse(text);
    return Number(text);
}

// The flat numbers of [1, 2] or [(1, 2), (3, 4)].
function numbersOf(text) {
    const words = text.replace(/[()[\]\s]/g, '').split(',').filter((word) => word !== '');
    return words.map(Number);
}

// The content of a layer in Pelagic's own text, as { layer: { field: value }, prim: {…}, attributes: { name: {…} } }.
// Each of its lines says one thing; empty lines, braces and dictionaries say nothing here.
function readText(text) {
    const layer = {};
    const prim = {};
    const attributes = {};
    let sampled = null;
    let depth = 0;
    for (const line of text.split('\n')) {
        if (/^ *(customLayerData|dictionary \w+) = \{$/.test(line)) depth += 1;
        else if (depth > 0) depth -= /^ *\}$/.test(line) ? 1 : 0;
        else if (/^(def|over)/.test(line)) {
            const [, specifier, type, name] = /^(def|over) (?:(\w+) )?"(\w+)"$/.exec(line);
            Object.assign(prim, { specifier, type, name });
        } else if (prim.name === undefined) {
            const field = /^ {4}(\w+) = (.*)$/.exec(line);
            if (field) layer[field[1]] = scalarOf(field[2]);
        } else if (sampled) {
            const sample = /^ {8}(-?\d+): ([[(].*[\])]),$/.exec(line);
            if (sample) sampled.samples = { time: Number(sample[1]), numbers: numbersOf(sample[2]) };
            else sampled = null;
        } else {
            const found =
                /^ {4}(uniform )?([\w[\]]+) ([\w:]+)(\.timeSamples)?(?: = (.*?))?(?: \(interpolation = "(\w+)"\))?$/
                    .exec(line);
            if (!found) continue;
            const [, variability, type, name, samples, value, interpolation] = found;
            attributes[name] = { variability: variability ?? '', type, interpolation };
            if (samples) sampled = attributes[name];
            else if (value?.startsWith('["')) attributes[name].value = JSON.parse(value);
            else if (value?.startsWith('[')) attributes[name].numbers = numbersOf(value);
            else if (value !== undefined) attributes[name].value = scalarOf(value);
        }
    }
    return { layer, prim, attributes };
}

// The same content of a crate, as three.js reads it.
function readCrate(USDCParser, file) {
    const bytes = fs.readFileSync(file);
    const { specsByPath } = new USDCParser().parseData(
        bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength));
    const isArray = (value) => Array.isArray(value) || ArrayBuffer.isView(value);
    const read = { layer: {}, prim: {}, attributes: {} };
    for (const [specPath, { specType, fields }] of Object.entries(specsByPath)) {
        if (specPath === '/') {
            if (specType !== 7) throw new Error(`the layer is a spec of type ${specType}`);
            const { customLayerData, primChildren, ...rest } = fields;
            Object.assign(read.layer, rest);
            read.prims = primChildren;
        } else if (specType === 6) {
            read.prim = { specifier: specifiers[fields.specifier], type: fields.typeName, name: specPath.slice(1) };
            read.properties = fields.properties;
        } else if (specType === 1) {
            const [, name] = specPath.split('.');
            const { typeName, custom, variability, interpolation, timeSamples, default: value, ...rest } = fields;
            for (const field of Object.keys(rest)) throw new Error(`${name} has a field ${field}`);
            if (custom !== false) throw new Error(`${name}: custom is ${custom}`);
            const attribute = { variability: variabilities[variability], type: typeName, interpolation };
            if (timeSamples) {
                if (timeSamples.values.length !== 1 || timeSamples.times.length !== 1) {
                    throw new Error(`${name} has ${timeSamples.values.length} samples`);
                }
                attribute.samples = { time: timeSamples.times[0], numbers: timeSamples.values[0] };
            }
            if (isArray(value) && typeName !== 'token[]') attribute.numbers = value;
            else if (value !== undefined) attribute.value = typeof value === 'boolean' ? Number(value) : value;
            read.attributes[name] = attribute;
        } else {
            throw new Error(`${specPath} is a spec of type ${specType}`);
        }
    }
    return read;
}

// Where the crate differs from the text, a line each; how many numbers were compared is added to `count`.
function differences(text, crate, count) {
    const found = [];
    const same = (what, wanted, got) => {
        if (JSON.stringify(wanted) !== JSON.stringify(got)) {
            found.push(`${what} is ${JSON.stringify(got)} instead of ${JSON.stringify(wanted)}`);
        }
    };
    const sorted = (object) => Object.fromEntries(Object.entries(object).sort());
    same('layer', sorted(text.layer), sorted(crate.layer));
    same('prim', text.prim, crate.prim);
    same('primChildren', [text.prim.name], crate.prims);
    same('properties', Object.keys(text.attributes), crate.properties);
    same('attributes', Object.keys(text.attributes), Object.keys(crate.attributes));
    const sameNumbers = (what, type, wanted, got) => {
        if ((wanted === undefined) !== (got === undefined)) found.push(`${what}: in one of the two only`);
        if (wanted === undefined || got === undefined) return;
        // three.js gives a single vector as a plain array.
        const Type = { 'int[]': Int32Array, double3: Array }[type] ?? Float32Array;
        if (got.length > 0 && !(got instanceof Type)) found.push(`${what} is a ${got.constructor.name}`);
        same(`${what}: length`, wanted.length, got.length);
        const rounded = Type.from(wanted);
        const at = rounded.findIndex((number, i) => !Object.is(number, got[i]));
        if (at >= 0) found.push(`${what}[${at}] is ${got[at]} instead of ${rounded[at]}`);
        count.numbers += got.length;
    };
    for (const [name, { numbers, samples, ...rest }] of Object.entries(text.attributes)) {
        const { numbers: gotNumbers, samples: gotSamples, ...got } = crate.attributes[name] ?? {};
        same(name, rest, got);
        sameNumbers(name, rest.type, numbers, gotNumbers);
        same(`${name}: time`, samples?.time, gotSamples?.time);
        sameNumbers(`${name}: samples`, rest.type, samples?.numbers, gotSamples?.numbers);
    }
    count.layers += 1;
    return found;
}

// A matrix as USD writes it, row after row, of a rotation about x, then y, then z [deg] and a translation.
function matrixOf(rotate, translate) {
    const rows = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((row) => {
        let [x, y, z] = row;
        const [[sx, cx], [sy, cy], [sz, cz]] = rotate.map((deg) => deg * Math.PI / 180)
            .map((angle) => [Math.sin(angle), Math.cos(angle)]);
        [y, z] = [y * cx - z * sx, y * sx + z * cx];
        [z, x] = [z * cy - x * sy, z * sy + x * cy];
        [x, y] = [x * cz - y * sz, x * sz + y * cz];
        return [x, y, z, 0];
    });
    return [...rows.flat(), ...translate, 1];
}

// Where a camera's crate differs from what is expected of it.
function differencesOfCamera(USDCParser, file, count) {
    const expected = JSON.parse(fs.readFileSync(file.replace(/usdc$/, 'json'), 'utf8'));
    const bytes = fs.readFileSync(file);
    const { specsByPath } = new USDCParser().parseData(
        bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength));
    const found = [];
    const same = (what, wanted, got) => {
        if (JSON.stringify(wanted) !== JSON.stringify(got)) {
            found.push(`${what} is ${JSON.stringify(got)} instead of ${JSON.stringify(wanted)}`);
        }
    };
    const layer = specsByPath['/'].fields;
    same('default prim', 'Camera', layer.defaultPrim);
    same('frames', [expected.first, expected.last], [layer.startTimeCode, layer.endTimeCode]);
    const prim = specsByPath['/Camera'].fields;
    same('prim', ['def', 'Camera'], [specifiers[prim.specifier], prim.typeName]);
    const valueOf = (name) => specsByPath[`/Camera.${name}`].fields.default;
    for (const name of ['horizontalAperture', 'verticalAperture']) {
        same(name, expected[name][0], valueOf(name));
    }
    same('projection', 'perspective', valueOf('projection'));
    same('clippingRange', [Math.fround(0.1), 1e6], valueOf('clippingRange'));
    same('xformOpOrder', ['xformOp:translate', 'xformOp:rotateXYZ'], valueOf('xformOpOrder'));
    // A camera that stands still has plain values, and no samples.
    const samplesOf = (name) => {
        const { timeSamples, default: value } = specsByPath[`/Camera.${name}`].fields;
        return timeSamples ?? { times: [expected.first], values: [value] };
    };
    const [translate, rotate] = ['xformOp:translate', 'xformOp:rotateXYZ'].map(samplesOf);
    const matrices = Object.entries(expected.matrices).map(([frame, wanted]) => [Number(frame), wanted])
        .sort(([a], [b]) => a - b);
    const focalLength = samplesOf('focalLength');
    same('focalLength', expected.focalLength, focalLength.values);
    for (const { times } of [translate, rotate, focalLength]) {
        same('times', matrices.map(([frame]) => frame), times);
    }
    matrices.forEach(([, wanted], i) => {
        const got = matrixOf(rotate.values[i], translate.values[i]);
        // Roundings of angles of less than a turn.
        const wrong = wanted.findIndex((value, k) => !(Math.abs(value - got[k]) < 1e-14));
        if (wrong >= 0) found.push(`matrix ${i}[${wrong}] is ${got[wrong]} instead of ${wanted[wrong]}`);
        // No step between frames is longer than half a turn.
        const before = rotate.values[Math.max(i - 1, 0)];
        const longest = Math.max(...rotate.values[i].map((angle, k) => Math.abs(angle - before[k])));
        if (longest > 180) found.push(`matrix ${i} is ${longest} degrees from the one before`);
        count.numbers += 6;
    });
    count.layers += 1;
    return found;
}

function differencesOfLarge(crate, count) {
    const found = [];
    for (const [name, components] of [['points', 3], ['primvars:whitecapCoverage', 1]]) {
        const { time, numbers } = crate.attributes[name].samples;
        if (time !== 12345) found.push(`${name} is at ${time}`);
        if (numbers.length !== components * 2049 * 2049) found.push(`${name} has ${numbers.length} numbers`);
        const at = numbers.findIndex((number, i) => number !== i);
        if (at >= 0) found.push(`${name}[${at}] is ${numbers[at]}`);
        count.numbers += numbers.length;
    }
    count.layers += 1;
    return found;
}

const words = process.argv.slice(2);
if (words.includes('--help') || words.includes('-h')) {
    console.log(help);
    process.exit(0);
}
const [dir, option, large] = words;
if (!dir || (option !== undefined && (option !== '--large' || !large)) || words.length > 3) {
    console.error('read-crates: wrong arguments; read-crates.mjs --help says more');
    process.exit(2);
}
const USDCParser = await loadParser();
const count = { layers: 0, numbers: 0 };
const found = [];
// The parser throws when a file is damaged.
const collect = (file, compare) => {
    try {
        found.push(...compare().map((line) => `${file}: ${line}`));
    } catch (error) {
        found.push(`${file}: ${error.message}`);
    }
};
for (const file of fs.readdirSync(dir, { recursive: true }).filter((name) => name.endsWith('.usdc')).sort()) {
    const crate = path.join(dir, file);
    if (file.endsWith('.camera.usdc')) collect(file, () => differencesOfCamera(USDCParser, crate, count));
    else collect(file, () => differences(readText(fs.readFileSync(crate.replace(/c$/, 'a'), 'utf8')),
        readCrate(USDCParser, crate), count));
}
if (count.layers === 0) found.push(`there is no crate below ${dir}`);
if (large) collect(large, () => differencesOfLarge(readCrate(USDCParser, large), count));
for (const line of found) console.error(`differs: ${line}`);
console.log(`${count.layers} layers, ${count.numbers} numbers; ${found.length} differences`);
process.exitCode = found.length > 0 ? 1 : 0;
