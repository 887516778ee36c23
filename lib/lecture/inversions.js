// SPDX-License-Identifier: GPL-3.0-or-later
// The figure of inversions, to drag: a point and a cell about it, from (xi1, xi2) to the normal m and the direction i.
const figure = document.getElementById("inversions");
const numbers = JSON.parse(document.getElementById("numbers-inversions").textContent);
const play = document.getElementById("inversions-play");
const [square, normals, directions] = figure.querySelectorAll(".disc > g");
const EDGE = 16;
const PARTS = 24;
const HORIZON = 1 - 1e-9; // xi2 = 1 is the horizon, at no finite slope
const SHRINK = 1.4; // the square inside its circle

const state = {
  xi1: (numbers.cell[1] + 0.5) / numbers.cells,
  xi2: (numbers.cell[0] + 0.5) / numbers.cells,
  sigma: numbers.sigma,
  degrees: numbers.degrees,
};

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const normalize = (a) => a.map((x) => x / Math.hypot(...a));
const clamp = (x, low, high) => Math.min(Math.max(x, low), high);

function observer() {
  const angle = (state.degrees * Math.PI) / 180;
  return [Math.sin(angle), 0, Math.cos(angle)];
}

// Example 2 of the lecture.
function toNormal([xi1, xi2]) {
  const slope = state.sigma * Math.sqrt(-Math.log1p(-Math.min(xi2, HORIZON)));
  const phi = 2 * Math.PI * xi1;
  const z = 1 / Math.sqrt(1 + slope * slope);
  return [slope * z * Math.cos(phi), slope * z * Math.sin(phi), z];
}

function reflect(m) {
  const o = observer();
  return m.map((x, k) => 2 * dot(o, m) * x - o[k]);
}

function fromNormal(m) {
  const turns = Math.atan2(m[1], m[0]) / (2 * Math.PI);
  const slope2 = (m[0] * m[0] + m[1] * m[1]) / (m[2] * m[2]);
  return [turns < 0 ? turns + 1 : turns, -Math.expm1(-slope2 / (state.sigma * state.sigma))];
}

function density(m) {
  const slope2 = (1 - m[2] * m[2]) / (m[2] * m[2]);
  const sigma2 = state.sigma * state.sigma;
  return Math.exp(-slope2 / sigma2) / (Math.PI * sigma2 * m[2] ** 3);
}

function outline(left, low, width) {
  const step = (k) => k / EDGE;
  const sides = [(t) => [t, 0], (t) => [1, t], (t) => [1 - t, 1], (t) => [0, 1 - t]];
  return sides.flatMap((side) => Array.from({ length: EDGE }, (_, k) => side(step(k))))
    .map(([x, y]) => [left + width * x, low + width * y]);
}

// By triangles on the sphere (Van Oosterom and Strackee 1983).
function solidAngle(grid) {
  let total = 0;
  for (let j = 0; j < PARTS; j++) {
    for (let k = 0; k < PARTS; k++) {
      const [a, b, c, d] = [grid[j][k], grid[j + 1][k], grid[j + 1][k + 1], grid[j][k + 1]];
      for (const [p, q, r] of [[a, b, c], [a, c, d]]) {
        total += 2 * Math.atan2(Math.abs(dot(p, cross(q, r))), 1 + dot(p, q) + dot(q, r) + dot(r, p));
      }
    }
  }
  return total;
}

function stretch(left, low, width) {
  const place = (j) => Array.from({ length: PARTS + 1 }, (_, k) =>
    toNormal([left + (width * j) / PARTS, low + (width * k) / PARTS]));
  const grid = Array.from({ length: PARTS + 1 }, (_, j) => place(j));
  return solidAngle(grid.map((row) => row.map(reflect))) / solidAngle(grid);
}

function element(name, attributes) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return made;
}

const inSquare = ([xi1, xi2]) => [SHRINK * (xi1 - 0.5), SHRINK * (xi2 - 0.5)];
const polygon = (points, kind) =>
  element("polygon", { class: kind, points: points.map((w) => `${w[0].toFixed(4)},${w[1].toFixed(4)}`).join(" ") });

function draw() {
  const width = 1 / numbers.cells;
  const cells = [];
  for (let row = 0; row < numbers.cells; row++) {
    for (let column = 0; column < numbers.cells; column++) cells.push([outline(column * width, row * width, width), "cell"]);
  }
  const left = clamp(state.xi1 - 0.5 * width, 0, 1 - width);
  const low = clamp(state.xi2 - 0.5 * width, 0, 1 - width);
  cells.push([outline(left, low, width), "cell chosen"]);
  const m = toNormal([state.xi1, state.xi2]);
  const i = reflect(m);
  const places = [inSquare([state.xi1, state.xi2]), m, i];
  for (const [k, group] of [square, normals, directions].entries()) {
    for (const old of group.querySelectorAll("polygon, .handle")) old.remove();
    for (const [corners, kind] of cells) {
      const points = k === 0 ? corners.map(inSquare) : corners.map(toNormal).map((w) => (k === 1 ? w : reflect(w)));
      if (k < 2 || points.every((w) => w[2] > 0)) group.append(polygon(points, kind));
    }
    if (k < 2 || i[2] > 0) group.append(element("circle", { class: "handle", cx: places[k][0], cy: places[k][1], r: 0.08 }));
  }
  say(m, i, stretch(left, low, width));
}

function say(m, i, widened) {
  const degrees = (z) => ((Math.acos(clamp(z, -1, 1)) * 180) / Math.PI).toFixed(1);
  const four = 4 * Math.abs(dot(observer(), m));
  const values = {
    xi1: state.xi1.toFixed(3), xi2: state.xi2.toFixed(3), sigma: state.sigma.toFixed(2), degrees: `${state.degrees}°`,
    m: `θ = ${degrees(m[2])}°, D cos θ = ${density(m).toPrecision(3)} / sr`,
    four: four.toFixed(3), widened: widened.toFixed(3),
    i: `θ = ${degrees(i[2])}°, D cos θ / (4 |o.m|) = ${(density(m) / four).toPrecision(3)} / sr`,
  };
  for (const [name, text] of Object.entries(values)) play.querySelector(`[data-shows=${name}]`).textContent = text;
  play.querySelector(".below").hidden = i[2] > 0;
  for (const input of play.querySelectorAll("input")) input.value = state[input.name];
  figure.querySelectorAll(".disc")[2].nextElementSibling.textContent = `i: × ${values.widened}; 4 |o.m| = ${values.four}`;
}

function move([xi1, xi2]) {
  state.xi1 = clamp(xi1, 0, 1);
  state.xi2 = clamp(xi2, 0, 0.999);
  draw();
}

// What a place in each of the three discs means, back in the square; a place outside a disc counts as one at its rim.
function onDisc(x, y) {
  const length = Math.max(Math.hypot(x, y) / 0.999, 1);
  return [x / length, y / length, Math.sqrt(1 - (x * x + y * y) / (length * length))];
}
const inverses = [
  (x, y) => [x / SHRINK + 0.5, y / SHRINK + 0.5],
  (x, y) => fromNormal(onDisc(x, y)),
  (x, y) => fromNormal(normalize(onDisc(x, y).map((w, k) => w + observer()[k]))),
];

for (const [k, svg] of figure.querySelectorAll(".disc").entries()) {
  const follow = (event) => {
    const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.firstElementChild.getScreenCTM().inverse());
    move(inverses[k](at.x, at.y));
  };
  svg.classList.add("live");
  svg.addEventListener("pointerdown", (event) => {
    svg.setPointerCapture(event.pointerId);
    follow(event);
  });
  svg.addEventListener("pointermove", (event) => svg.hasPointerCapture(event.pointerId) && follow(event));
}
for (const input of play.querySelectorAll("input")) {
  input.addEventListener("input", () => {
    state[input.name] = Number(input.value);
    draw();
  });
}
play.hidden = false;
draw();
document.documentElement.dataset.ready = "";
