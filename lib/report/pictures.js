/* What the page holds, and the pictures made of it: each is painted once per setting into a canvas of its own. */

const view = JSON.parse(document.getElementById("view").textContent);
const { width, height, step, floor, tolerance, names } = view;
const element = (id) => document.getElementById(id);

async function unpack(id) {
  const text = atob(element(id).textContent);
  const bytes = Uint8Array.from(text, (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/* The floats whose first bytes come first, then all second ones, and so on. */
function joinBytes(planes) {
  const count = planes.length / 4;
  const bytes = new Uint8Array(planes.length);
  for (let i = 0; i < count; i++) for (let b = 0; b < 4; b++) bytes[4 * i + b] = planes[b * count + i];
  return new Float32Array(bytes.buffer);
}

/* What is shown: both sides' light and their significances, of the whole image or of one light pass (passes.js). */
let [reference, candidate] = (await Promise.all(["floats-0", "floats-1"].map(unpack))).map(joinBytes);
const [flip, codes] = await Promise.all(["flip", "significance"].map(unpack));
let significances = new Int8Array(codes.buffer);
const maps = new Uint16Array((await unpack("labels")).buffer);

const regions = view.regions.map((region, index) => ({ ...pickChannel(region), index }));
const blocks = regions.filter((region) => region.kind === "block");
const shots = ["shot-0", "shot-1"].map(element);
await Promise.all(shots.map((image) => image.decode()));

const state = {
  mode: "beside", display: view.transform ? "scene" : "standard", channel: "rgb", exposure: view.exposure, limit: Math.log2(view.limit), split: 0.5,
  scale: 0, x: 0, y: 0, chosen: [], hovered: null, pass: -1,
};

/* The relative difference of one channel of one pixel, by its place in the floats. */
const relative = (i) => relativeDifference(candidate[i] - reference[i], reference[i], floor[i % 3]);

/* (Cycles - reference) / standard error of one channel of one pixel; NaN where there is none. */
const significance = (i) => (significances[i] === view.significance.none ? NaN : significances[i] / view.significance.one);

/* The places, in the floats of the pixel that begins at i, of the channels that are looked at. */
const CHANNELS = { rgb: [0, 1, 2], luminance: [0, 1, 2], r: [0], g: [1], b: [2] };

/* The mean over these channels of what `value` says, each cut off at -limit and limit. */
function meanOver(value, i, limit) {
  const channels = CHANNELS[state.channel];
  let sum = 0;
  for (const c of channels) sum += Math.min(limit, Math.max(-limit, value(i + c)));
  return sum / channels.length;
}

/* The light of a pixel as one number: that of one channel, or its luminance. */
function light(values, i) {
  const channels = CHANNELS[state.channel];
  return channels.length === 1 ? values[i + channels[0]] : luminance(values[i], values[i + 1], values[i + 2]);
}

function painted(colorOf) {
  const canvas = document.createElement("canvas");
  canvas.width = width;
  canvas.height = height;
  const context = canvas.getContext("2d");
  const image = context.createImageData(width, height);
  for (let pixel = 0; pixel < width * height; pixel++) {
    const color = colorOf(3 * pixel) ?? hatch(pixel);
    for (let c = 0; c < 3; c++) image.data[4 * pixel + c] = color[c];
    image.data[4 * pixel + 3] = 255;
  }
  context.putImageData(image, 0, 0);
  return canvas;
}

/* What is not compared is hatched. */
const hatch = (pixel) => (((pixel % width) + Math.floor(pixel / width)) % 8 < 4 ? [255, 0, 255] : [128, 0, 128]);

const SRGB = Uint8Array.from({ length: 4097 }, (_, i) => Math.round(255 * encodeSrgb(i / 4096)));
const FALSE_COLORS = Array.from({ length: 257 }, (_, i) => colorMagma(i / 256));
const encode = (linear) => SRGB[Math.min(4096, Math.max(0, Math.round(linear * 4096)))];

function paintRadiance(values, shot) {
  if (state.display === "scene") return shot;
  const gain = 2 ** state.exposure;
  return painted((i) => {
    if (Number.isNaN(values[i])) return null;
    if (state.display === "false") return FALSE_COLORS[Math.round(256 * placeFalseColor(light(values, i) * gain))];
    if (state.channel === "rgb") return [0, 1, 2].map((c) => encode(values[i + c] * gain));
    return new Array(3).fill(encode(light(values, i) * gain));
  });
}

function paintSigned(value, limit) {
  return painted((i) => {
    const mean = meanOver(value, i, limit);
    return Number.isNaN(mean) ? null : colorSigned(mean / limit);
  });
}

function paintFlip() {
  return painted((i) => (flip[i / 3] === view.flip.none ? null : colorMagma(flip[i / 3] / view.flip.one)));
}

const MAP_COLORS = { EQUIVALENT: [27, 127, 92], DIFFERENT: [200, 62, 36], UNDECIDED: [214, 176, 50], EXPLAINED: [64, 119, 190] };
function paintMap(colorOf) {
  const canvas = document.createElement("canvas");
  canvas.width = width;
  canvas.height = height;
  const context = canvas.getContext("2d");
  for (const block of blocks) {
    context.fillStyle = `rgb(${colorOf(block).join(" ")})`;
    context.fillRect(...placeBox(block.box, step));
  }
  context.globalAlpha = 0.55;
  context.globalCompositeOperation = "luminosity";
  context.drawImage(picture("reference"), 0, 0);
  return canvas;
}

const PAINTERS = {
  reference: () => paintRadiance(reference, shots[0]),
  candidate: () => paintRadiance(candidate, shots[1]),
  difference: () => paintSigned(relative, tolerance * 2 ** state.limit),
  significance: () => paintSigned(significance, view.significance.limit),
  flip: paintFlip,
  map: () => paintMap((block) => MAP_COLORS[block.outcome]),
  bounds: () => paintMap((block) => colorBound(block.bound, tolerance)),
};

/* Pictures that hold for the present settings; painted when they are first drawn. */
const pictures = {};
function picture(what) {
  pictures[what] ??= PAINTERS[what]();
  return pictures[what];
}
function repaint() {
  for (const what of Object.keys(pictures)) delete pictures[what];
}

/* The outline of a region: that of its pixels if a map of its kind has them, else its box. */
const outlines = new Map();
function outlineOf(region) {
  if (!outlines.has(region.index)) {
    const path = new Path2D();
    const kind = view.kinds.indexOf(region.kind);
    const edges = kind < 0 ? [] : outline(maps.subarray(kind * width * height, (kind + 1) * width * height), width, region.index + 1);
    for (const [x0, y0, x1, y1] of edges) {
      path.moveTo(x0, y0);
      path.lineTo(x1, y1);
    }
    if (!edges.length) path.rect(...placeBox(region.box, step));
    outlines.set(region.index, path);
  }
  return outlines.get(region.index);
}
