const view = JSON.parse(document.getElementById("view").textContent);
const { width, height, step, floor, tolerance, names } = view;
const OUTCOMES = ["EQUIVALENT", "EXPLAINED", "DIFFERENT", "UNDECIDED"];
const MAP_COLORS = { EQUIVALENT: [27, 127, 92], DIFFERENT: [200, 62, 36], UNDECIDED: [214, 176, 50], EXPLAINED: [64, 119, 190] };
const element = (id) => document.getElementById(id);

function unpacked(id) {
  const text = atob(element(id).textContent);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  return bytes;
}

const [reference, candidate] = ["floats-0", "floats-1"].map((id) => new Float32Array(unpacked(id).buffer));
const flip = unpacked("flip");

const regions = view.regions.map(pickChannel);
const blocks = regions.filter((region) => region.kind === "block");

/* The relative difference of one channel of one pixel, by its place in the floats. */
const relative = (i) => relativeDifference(candidate[i] - reference[i], reference[i], floor[i % 3]);

/* Images: each painted once per setting into a canvas of its own, then drawn into the panes. */

const state = { mode: "beside", exposure: view.exposure, limit: Math.log2(view.limit), split: 0.5, scale: 0, x: 0, y: 0, box: null };

function painted(colorOf) {
  const canvas = document.createElement("canvas");
  canvas.width = width;
  canvas.height = height;
  const context = canvas.getContext("2d");
  const image = context.createImageData(width, height);
  const color = [0, 0, 0];
  for (let pixel = 0; pixel < width * height; pixel++) {
    colorOf(3 * pixel, color);
    image.data[4 * pixel] = color[0];
    image.data[4 * pixel + 1] = color[1];
    image.data[4 * pixel + 2] = color[2];
    image.data[4 * pixel + 3] = 255;
  }
  context.putImageData(image, 0, 0);
  return canvas;
}

const SRGB = Uint8Array.from({ length: 4097 }, (_, i) => Math.round(255 * encodeSrgb(i / 4096)));

/* What is not compared is hatched. */
function hatch(i, color) {
  const pixel = i / 3;
  const light = ((pixel % width) + Math.floor(pixel / width)) % 8 < 4;
  color[0] = color[2] = light ? 255 : 128;
  color[1] = 0;
}

function paintRadiance(values) {
  const gain = 4096 * 2 ** state.exposure;
  return painted((i, color) => {
    if (Number.isNaN(values[i])) return hatch(i, color);
    for (let c = 0; c < 3; c++) color[c] = SRGB[Math.min(4096, Math.max(0, Math.round(values[i + c] * gain)))];
  });
}

function paintDifference() {
  const limit = tolerance * 2 ** state.limit;
  const ends = [[33, 102, 172], [178, 24, 43]];
  return painted((i, color) => {
    let sum = 0;
    for (let c = 0; c < 3; c++) sum += Math.min(1, Math.max(-1, relative(i + c) / limit));
    if (Number.isNaN(sum)) return hatch(i, color);
    const end = ends[sum < 0 ? 0 : 1];
    const share = Math.abs(sum) / 3;
    for (let c = 0; c < 3; c++) color[c] = 247 + (end[c] - 247) * share;
  });
}

/* Matplotlib's magma, which FLIP's authors use, at every eighth of its way. */
const MAGMA = [[0, 0, 4], [28, 16, 68], [79, 18, 123], [129, 37, 129], [181, 54, 122], [229, 80, 100], [251, 135, 97], [254, 194, 135], [252, 253, 191]];

function paintFlip() {
  return painted((i, color) => {
    const value = flip[i / 3];
    if (value === view.flip.none) return hatch(i, color);
    const place = (value / view.flip.one) * (MAGMA.length - 1);
    const low = Math.min(Math.floor(place), MAGMA.length - 2);
    for (let c = 0; c < 3; c++) color[c] = MAGMA[low][c] + (MAGMA[low + 1][c] - MAGMA[low][c]) * (place - low);
  });
}

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
  context.drawImage(paint.reference, 0, 0);
  return canvas;
}

const paint = { flip: paintFlip() };
function repaint() {
  paint.reference = paintRadiance(reference);
  paint.candidate = paintRadiance(candidate);
  paint.difference = paintDifference();
  paint.map = paintMap((block) => MAP_COLORS[block.outcome]);
  paint.bounds = paintMap((block) => colorBound(block.bound, tolerance));
}

const PANES = {
  beside: [[names[0], "reference"], [names[1], "candidate"], ["Relative difference", "difference"]],
  slider: [[`${names[0]} left of the line, ${names[1]} right of it`, "reference"]],
  difference: [["Relative difference", "difference"], ["FLIP, for the eye only", "flip"]],
  map: [["Verdict of each cell, over the reference", "map"], ["How closely each cell agrees: green within the tolerance, yellow to red up to 30 times that", "bounds"]],
};
let panes = [];

function layOut() {
  const holder = element("panes");
  holder.replaceChildren();
  panes = PANES[state.mode].map(([caption, what]) => {
    const figure = document.createElement("figure");
    const canvas = document.createElement("canvas");
    const label = document.createElement("figcaption");
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", caption);
    label.textContent = caption;
    figure.append(canvas, label);
    holder.append(figure);
    listen(canvas);
    return { canvas, what };
  });
  for (const part of document.querySelectorAll(".eye")) part.hidden = state.mode !== "difference";
  element("split-label").hidden = state.mode !== "slider";
  for (const button of document.querySelectorAll("[data-mode]")) button.setAttribute("aria-pressed", button.dataset.mode === state.mode);
  fit();
}

function fit() {
  for (const { canvas } of panes) {
    const across = canvas.clientWidth;
    const down = Math.min(across * height / width, 0.72 * window.innerHeight);
    canvas.style.height = down + "px";
    canvas.width = Math.round(across * devicePixelRatio);
    canvas.height = Math.round(down * devicePixelRatio);
  }
  const { canvas } = panes[0];
  state.scale = Math.min(canvas.width / width, canvas.height / height);
  state.x = (canvas.width - width * state.scale) / 2;
  state.y = (canvas.height - height * state.scale) / 2;
  draw();
}

function draw() {
  for (const { canvas, what } of panes) {
    const context = canvas.getContext("2d");
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, canvas.width, canvas.height);
    context.setTransform(state.scale, 0, 0, state.scale, state.x, state.y);
    context.imageSmoothingEnabled = state.scale < 1;
    context.drawImage(paint[what], 0, 0);
    if (state.mode === "slider") {
      const at = Math.round(state.split * canvas.width);
      context.save();
      context.setTransform(1, 0, 0, 1, 0, 0);
      context.beginPath();
      context.rect(at, 0, canvas.width, canvas.height);
      context.clip();
      context.setTransform(state.scale, 0, 0, state.scale, state.x, state.y);
      context.drawImage(paint.candidate, 0, 0);
      context.restore();
      context.setTransform(1, 0, 0, 1, 0, 0);
      context.fillStyle = "#fff";
      context.fillRect(at - 1, 0, 2, canvas.height);
      context.fillStyle = "#000";
      context.fillRect(at + 1, 0, 1, canvas.height);
    }
    if (state.box) {
      context.setTransform(state.scale, 0, 0, state.scale, state.x, state.y);
      for (const [color, wide] of [["#000", 4], ["#ffd84a", 2]]) {
        context.strokeStyle = color;
        context.lineWidth = wide / state.scale;
        context.strokeRect(...placeBox(state.box, step));
      }
    }
  }
}

function listen(canvas) {
  let last = null;
  let dragsLine = false;
  const place = (event) => [event.offsetX * devicePixelRatio, event.offsetY * devicePixelRatio];
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    const [x, y] = place(event);
    const factor = Math.min(Math.max(state.scale * Math.exp(-event.deltaY / 300), 0.05), 200) / state.scale;
    state.x = x - (x - state.x) * factor;
    state.y = y - (y - state.y) * factor;
    state.scale *= factor;
    draw();
  }, { passive: false });
  canvas.addEventListener("pointerdown", (event) => {
    last = place(event);
    dragsLine = state.mode === "slider" && Math.abs(last[0] - state.split * canvas.width) < 12 * devicePixelRatio;
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointerup", () => { last = null; });
  canvas.addEventListener("pointermove", (event) => {
    const now = place(event);
    if (last) {
      if (dragsLine) {
        state.split = Math.min(Math.max(now[0] / canvas.width, 0), 1);
        element("split").value = state.split;
      } else {
        state.x += now[0] - last[0];
        state.y += now[1] - last[1];
      }
      last = now;
      draw();
    }
    read(Math.floor((now[0] - state.x) / state.scale), Math.floor((now[1] - state.y) / state.scale));
  });
}

function read(x, y) {
  if (x < 0 || y < 0 || x >= width || y >= height) return;
  const i = 3 * (y * width + x);
  const rgb = (values) => [0, 1, 2].map((c) => formatNumber(values[i + c])).join("  ");
  const block = findRegion(blocks, x * step, y * step);
  const gap = [0, 1, 2].map((c) => formatPercent(relative(i + c))).join("  ");
  const seen = state.mode === "difference" && flip[i / 3] !== view.flip.none ? `   FLIP ${(flip[i / 3] / view.flip.one).toFixed(2)}` : "";
  element("reading").textContent =
    `x ${x * step}, y ${y * step}   ${names[0]} ${rgb(reference)}   ${names[1]} ${rgb(candidate)}   difference ${gap}${seen}\n` +
    (block ? `Cell ${block.name}: ${block.outcome}, agrees within ${formatBound(block.bound)}; ` +
      `${formatPercent(block.difference)} in ${"RGB"[block.channel]} (${formatPercent(block.low)} to ${formatPercent(block.high)})` : "");
}

for (const button of document.querySelectorAll("[data-mode]")) {
  button.addEventListener("click", () => {
    state.mode = button.dataset.mode;
    layOut();
  });
}

function showSettings() {
  element("exposure-value").textContent = `${state.exposure > 0 ? "+" : ""}${state.exposure} EV`;
  const limit = formatPercent(tolerance * 2 ** state.limit).slice(1);
  element("limit-value").textContent = `± ${limit}`;
  element("scale-ends").textContent = `relative difference, −${limit} to +${limit}`;
}

for (const key of ["exposure", "limit"]) {
  element(key).value = state[key];
  element(key).addEventListener("input", (event) => {
    state[key] = Number(event.target.value);
    showSettings();
    repaint();
    draw();
  });
}
element("split").addEventListener("input", (event) => {
  state.split = Number(event.target.value);
  draw();
});
element("fit").addEventListener("click", fit);
window.addEventListener("resize", fit);

/* The bar of counts and the table of regions. */

for (const outcome of OUTCOMES) {
  const count = regions.filter((region) => region.outcome === outcome).length;
  if (!count) continue;
  const part = document.createElement("span");
  part.className = outcome;
  part.style.flexGrow = count;
  part.title = `${count} ${outcome}`;
  element("counts").append(part);
}

const MOST_ROWS = 500;
const table = { key: "size", descending: true };
const kinds = [...new Set(regions.map((region) => region.kind))];
const named = kinds.filter((kind) => kind !== "block");
for (const [label, value] of [["what you named", "named"], ["everything", ""], ...kinds.map((kind) => [kind, kind])]) {
  element("kind").append(new Option(label, value));
}
if (named.length < 2) element("kind").value = "";

function cell(row, text, className) {
  const td = row.insertCell();
  td.textContent = text;
  td.className = className;
}

function fill() {
  const filters = { kind: element("kind").value, outcome: element("outcome").value, search: element("search").value };
  const rows = regions.filter((region) => matchesFilters(region, filters));
  rows.sort((a, b) => compareRegions(a, b, table.key, table.descending));
  const body = element("table").tBodies[0];
  body.replaceChildren();
  for (const region of rows.slice(0, MOST_ROWS)) {
    const row = body.insertRow();
    cell(row, region.kind, "");
    cell(row, region.name, "name");
    cell(row, region.outcome, region.outcome);
    cell(row, formatBound(region.bound), "number");
    cell(row, `${formatPercent(region.difference)} ${"RGB"[region.channel]}`, "number");
    cell(row, `${formatPercent(region.low)} to ${formatPercent(region.high)}`, "number");
    cell(row, formatNumber(region.reference), "number");
    cell(row, formatNumber(region.candidate), "number");
    cell(row, region.excluded_pixels ? `${region.pixels} (${region.excluded_pixels} excluded)` : `${region.pixels}`, "number");
    cell(row, region.decided_at || "–", "number");
    row.addEventListener("pointerenter", () => { state.box = region.box; draw(); });
    row.addEventListener("pointerleave", () => { state.box = null; draw(); });
  }
  const cut = rows.length > MOST_ROWS ? `, the first ${MOST_ROWS} shown` : "";
  element("shown").textContent = `${rows.length} of ${regions.length} regions${cut}`;
  for (const th of document.querySelectorAll("th[data-key]")) {
    if (th.dataset.key === table.key) th.setAttribute("aria-sort", table.descending ? "descending" : "ascending");
    else th.removeAttribute("aria-sort");
  }
}

for (const th of document.querySelectorAll("th[data-key]")) {
  th.addEventListener("click", () => {
    table.descending = table.key === th.dataset.key ? !table.descending : th.classList.contains("number");
    table.key = th.dataset.key;
    fill();
  });
}
for (const id of ["kind", "outcome", "search"]) element(id).addEventListener("input", fill);

showSettings();
repaint();
layOut();
fill();
