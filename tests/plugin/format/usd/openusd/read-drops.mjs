#!/usr/bin/env node
// Reads the drops of two frames with three.js's USDCParser: whether they are what points of USD should be, and whether their
// velocities are the ways from one frame to the next. See --help.
import fs from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';

const help = `Usage: read-drops.mjs FIRST.usdc NEXT.usdc FPS

Exit status: 0 all well; 1 something is wrong; 2 wrong arguments; 3 could not run (not installed). Install once with install.sh.`;

const here = path.dirname(fileURLToPath(import.meta.url));
const types = { extent: 'float3[]', ids: 'int64[]', points: 'point3f[]', 'primvars:displayOpacity': 'float[]',
                'primvars:extinctionSection': 'float[]', velocities: 'vector3f[]', widths: 'float[]' };

async function loadParser() {
    try {
        return (await import('three/examples/jsm/loaders/usd/USDCParser.js')).USDCParser;
    } catch {
        console.error(`read-drops: not installed; run ${path.join(here, 'install.sh')}`);
        process.exit(3);
    }
}

function need(holds, what) {
    if (holds) return;
    console.error(`read-drops: ${what}`);
    process.exit(1);
}

// three.js passes arrays of int64 over.
function withIds(USDCParser) {
    return class extends USDCParser {
        _readArrayValue(valueRep) {
            if (valueRep.typeEnum !== 5) return super._readArrayValue(valueRep);
            return Array.from({ length: this.reader.readUint64() }, () => this.reader.readInt64());
        }
    };
}

// {name: numbers}, and the frame.
function read(Parser, file) {
    const bytes = fs.readFileSync(file);
    const { specsByPath } = new Parser().parseData(
        bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength));
    const prim = specsByPath['/Drops'].fields;
    need(prim.typeName === 'Points' && prim.specifier === 0, `${file}: no Points`);
    const found = {};
    for (const [name, type] of Object.entries(types)) {
        const { typeName, timeSamples, interpolation } = specsByPath[`/Drops.${name}`].fields;
        need(typeName === type, `${file}: ${name} is of type ${typeName}`);
        const isPerPoint = name.startsWith('primvars:') || name === 'widths';
        need(interpolation === (isPerPoint ? 'vertex' : undefined), `${file}: ${name} is ${interpolation}`);
        need(timeSamples.times.length === 1, `${file}: ${name} has ${timeSamples.times.length} samples`);
        [found.time] = timeSamples.times;
        found[name] = Array.from(timeSamples.values[0]);
        need(found[name].every(Number.isFinite), `${file}: ${name} has what is no number`);
    }
    const count = found.ids.length;
    need(count > 100 && new Set(found.ids).size === count, `${file}: ${count} ids, or two are the same`);
    for (const name of ['points', 'velocities']) need(found[name].length === 3 * count, `${file}: ${name} are too few`);
    for (const name of ['widths', 'primvars:displayOpacity', 'primvars:extinctionSection'])
        need(found[name].length === count && found[name].every((value) => value > 0), `${file}: ${name} aren't all above 0`);
    need(found['primvars:displayOpacity'].every((value) => value <= 1), `${file}: opacities above 1`);
    found.points.forEach((at, i) => need(
        at - found.widths[Math.floor(i / 3)] / 2 >= found.extent[i % 3] - 1e-4 &&
        at + found.widths[Math.floor(i / 3)] / 2 <= found.extent[3 + (i % 3)] + 1e-4, `${file}: a parcel outside the extent`));
    return found;
}

const args = process.argv.slice(2);
if (args.includes('--help')) {
    console.log(help);
    process.exit(0);
}
if (args.length !== 3) {
    console.error(help);
    process.exit(2);
}
const Parser = withIds(await loadParser());
const [first, next] = args.slice(0, 2).map((file) => read(Parser, file));
need(next.time === first.time + 1, 'the second file is not of the next frame');
const later = new Map(next.ids.map((id, i) => [id, i]));
let both = 0;
let worst = 0;
first.ids.forEach((id, i) => {
    const at = later.get(id);
    if (at === undefined) return;
    both += 1;
    for (let c = 0; c < 3; c += 1) {
        const way = (next.points[3 * at + c] - first.points[3 * i + c]) * Number(args[2]);
        worst = Math.max(worst, Math.abs(way - 0.5 * (first.velocities[3 * i + c] + next.velocities[3 * at + c])));
    }
});
need(both > 0.9 * first.ids.length, `${both} of ${first.ids.length} drops are in both frames`);
// Floats of places, and how velocities change within a frame.
need(worst < 0.02, `a velocity is ${worst} m/s off`);
console.log(`read-drops: ${first.ids.length} drops, ${both} in both frames; velocities within ${worst.toFixed(4)} m/s of their ways`);
