/* The panes: what is drawn in them, and what mouse, finger and keys do there. */

const PANES = {
  beside: [[names[0], "reference"], [names[1], "candidate"], ["Relative difference", "difference"]],
  split: [[`${names[0]} left of the divider, ${names[1]} right of it`, "reference"]],
  difference: [["Relative difference", "difference"], ["Significance: difference divided by its standard error", "significance"]],
  map: [["Verdict of each block, over the reference", "map"], ["Bound of each block: green within the tolerance, yellow to red up to 30 times that", "bounds"]],
  eye: [[names[0], "reference"], [names[1], "candidate"], ["FLIP, for the eye only", "flip"]],
};
const MODES = Object.keys(PANES);
// It moves into the pane of the split view and, with it, out of the page.
const divider = element("divider");
let panes = [];

function layOut() {
  const holder = element("panes");
  holder.replaceChildren();
  panes = PANES[state.mode].map(([caption, what]) => {
    const figure = document.createElement("figure");
    const holds = document.createElement("div");
    const canvas = document.createElement("canvas");
    const label = document.createElement("figcaption");
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", `${caption}. Arrow keys move, plus and minus zoom, 0 fits.`);
    canvas.tabIndex = 0;
    label.textContent = caption;
    holds.className = "holds";
    holds.append(canvas);
    if (state.mode === "split") holds.append(divider);
    figure.append(holds, label);
    holder.append(figure);
    listen(canvas);
    return { canvas, what };
  });
  divider.hidden = state.mode !== "split";
  for (const part of document.querySelectorAll("[data-for]")) part.hidden = !part.dataset.for.split(" ").includes(state.mode);
  for (const button of document.querySelectorAll("[data-mode]")) button.setAttribute("aria-pressed", button.dataset.mode === state.mode);
  fit();
}

function measure() {
  for (const { canvas } of panes) {
    const across = canvas.clientWidth;
    const down = Math.min((across * height) / width, 0.72 * window.innerHeight);
    canvas.style.height = down + "px";
    canvas.width = Math.round(across * devicePixelRatio);
    canvas.height = Math.round(down * devicePixelRatio);
  }
}

function fit() {
  measure();
  const { canvas } = panes[0];
  state.scale = Math.min(canvas.width / width, canvas.height / height);
  state.x = (canvas.width - width * state.scale) / 2;
  state.y = (canvas.height - height * state.scale) / 2;
  draw();
}

/* Show the box around regions; the whole image, where that is what they are. */
function zoomTo(chosen) {
  if (!chosen.length || chosen.some((region) => region.kind === "image")) return fit();
  const { canvas } = panes[0];
  Object.assign(state, frame(placeBox(joinBoxes(chosen), step), canvas.width, canvas.height));
  draw();
}

function zoomBy(factor, x, y) {
  const bounded = Math.min(Math.max(state.scale * factor, 0.05), 200) / state.scale;
  state.x = x - (x - state.x) * bounded;
  state.y = y - (y - state.y) * bounded;
  state.scale *= bounded;
  draw();
}

let isDue = false;
function draw() {
  if (isDue) return;
  isDue = true;
  requestAnimationFrame(() => {
    isDue = false;
    for (const pane of panes) drawPane(pane);
    drawHistograms();
  });
}

function drawPane({ canvas, what }) {
  const context = canvas.getContext("2d");
  const place = () => context.setTransform(state.scale, 0, 0, state.scale, state.x, state.y);
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.clearRect(0, 0, canvas.width, canvas.height);
  context.imageSmoothingEnabled = state.scale < 1;
  place();
  context.drawImage(picture(what), 0, 0);
  if (state.mode === "split") {
    context.save();
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.beginPath();
    context.rect(Math.round(state.split * canvas.width), 0, canvas.width, canvas.height);
    context.clip();
    place();
    context.drawImage(picture("candidate"), 0, 0);
    context.restore();
    divider.style.left = `${100 * state.split}%`;
    divider.setAttribute("aria-valuenow", Math.round(100 * state.split));
  }
  place();
  const drawn = state.hovered ? [...state.chosen, state.hovered] : state.chosen;
  for (const [color, wide] of [["#000", 4], ["#ffd84a", 2]]) {
    context.strokeStyle = color;
    context.lineWidth = (wide * Math.min(devicePixelRatio, 2)) / state.scale;
    for (const region of drawn) context.stroke(outlineOf(region));
  }
}

const toPixel = (x, y) => [Math.floor((x - state.x) / state.scale), Math.floor((y - state.y) / state.scale)];

function listen(canvas) {
  const pointers = new Map();
  let moved = 0;
  const place = (event) => [event.offsetX * devicePixelRatio, event.offsetY * devicePixelRatio];
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    zoomBy(Math.exp(-event.deltaY / 300), ...place(event));
  }, { passive: false });
  canvas.addEventListener("pointerdown", (event) => {
    pointers.set(event.pointerId, place(event));
    moved = 0;
    canvas.setPointerCapture(event.pointerId);
  });
  for (const end of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(end, (event) => {
      pointers.delete(event.pointerId);
      if (end === "pointerup" && moved < 4) chooseAt(...toPixel(...place(event)));
    });
  }
  canvas.addEventListener("pointermove", (event) => {
    const now = place(event);
    const last = pointers.get(event.pointerId);
    if (last) {
      moved += Math.abs(now[0] - last[0]) + Math.abs(now[1] - last[1]);
      if (moved >= 4) {
        state.x += now[0] - last[0];
        state.y += now[1] - last[1];
        draw();
      }
      pointers.set(event.pointerId, now);
    }
    read(...toPixel(...now));
  });
  canvas.addEventListener("focus", () => read(...toPixel(canvas.width / 2, canvas.height / 2)));
  canvas.addEventListener("keydown", (event) => {
    const far = 0.1 * canvas.width;
    const moves = { ArrowLeft: [far, 0], ArrowRight: [-far, 0], ArrowUp: [0, far], ArrowDown: [0, -far] }[event.key];
    const middle = [canvas.width / 2, canvas.height / 2];
    if (moves) {
      state.x += moves[0];
      state.y += moves[1];
      draw();
    } else if (event.key === "+" || event.key === "=") zoomBy(1.5, ...middle);
    else if (event.key === "-") zoomBy(1 / 1.5, ...middle);
    else if (event.key === "0") fit();
    else return;
    event.preventDefault();
    read(...toPixel(...middle));
  });
}

/* The values at a pixel of the view, in words. */
function read(x, y) {
  if (x < 0 || y < 0 || x >= width || y >= height) return;
  const i = 3 * (y * width + x);
  const three = (tell) => [0, 1, 2].map((c) => tell(i + c)).join("  ");
  const sigma = three((at) => (Number.isNaN(significance(at)) ? "none" : significance(at).toFixed(1)));
  const seen = flip[i / 3] === view.flip.none ? "" : `   FLIP ${(flip[i / 3] / view.flip.one).toFixed(2)}`;
  const block = findRegion(blocks, x * step, y * step);
  element("reading").textContent =
    `x ${x * step}, y ${y * step}   ${names[0]} ${three((at) => formatNumber(reference[at]))}   ${names[1]} ${three((at) => formatNumber(candidate[at]))}\n` +
    `difference ${three((at) => formatPercent(relative(at)))}   in standard errors ${sigma}${seen}\n` +
    (block ? `Block ${block.name}: ${block.outcome}, bound ${formatBound(block.bound)}; ` +
      `${formatPercent(block.difference)} in ${"RGB"[block.channel]} (${formatPercent(block.low)} to ${formatPercent(block.high)})` : "");
  readPasses(i);
}

/* The divider of the split view. */
function moveDivider(share) {
  state.split = Math.min(Math.max(share, 0), 1);
  draw();
}
divider.addEventListener("pointerdown", (event) => divider.setPointerCapture(event.pointerId));
divider.addEventListener("pointermove", (event) => {
  if (!divider.hasPointerCapture(event.pointerId)) return;
  const across = divider.parentElement.getBoundingClientRect();
  moveDivider((event.clientX - across.left) / across.width);
});
divider.addEventListener("keydown", (event) => {
  const to = { ArrowLeft: state.split - 0.02, ArrowRight: state.split + 0.02, Home: 0, End: 1 }[event.key];
  if (to === undefined) return;
  event.preventDefault();
  moveDivider(to);
});

/* Histograms of the pixels in view. */
const SIGMA_BINS = 21;
function drawHistograms() {
  if (!element("histograms").open) return;
  const { canvas } = panes[0];
  const [x0, y0] = toPixel(0, 0).map((at) => Math.max(at, 0));
  const [x1, y1] = toPixel(canvas.width, canvas.height);
  const values = [[], [], []];
  for (let y = y0; y <= Math.min(y1, height - 1); y++) {
    for (let x = x0; x <= Math.min(x1, width - 1); x++) {
      const i = 3 * (y * width + x);
      [reference, candidate].forEach((side, k) => {
        const here = light(side, i);
        values[k].push(here > 0 ? Math.log2(here) : here <= 0 ? -Infinity : NaN);
      });
      for (const c of CHANNELS[state.channel]) values[2].push(significance(i + c));
    }
  }
  const white = -state.exposure;
  const of = (k) => histogram(values[k], white - 12, white + 4, 64);
  plot(element("light-histogram"), [[of(0), "--ink"], [of(1), "--DIFFERENT"]]);
  // Codes are whole numbers; bins of five codes, with 0 in the middle of one, hold equally many each.
  const half = (SIGMA_BINS * 5) / view.significance.one / 2;
  const bins = histogram(values[2], -half, half, SIGMA_BINS);
  const wide = (2 * half) / SIGMA_BINS;
  const normal = bins.map((_, k) => (wide / Math.sqrt(2 * Math.PI)) * Math.exp(-0.5 * ((k + 0.5) * wide - half) ** 2));
  plot(element("significance-histogram"), [[bins, "--ink"], [normal, "--EQUIVALENT"]]);
  const known = values[2].filter((value) => !Number.isNaN(value));
  const beyond = known.filter((value) => Math.abs(value) > 3).length / (known.length || 1);
  element("beyond").textContent = known.length
    ? `${(100 * beyond).toFixed(2)} % of the values in view are beyond ±3 standard errors (0.27 % of normal noise).`
    : "No standard error is known in view: that takes two replicates on each side.";
}

/* Curves of shares over their bins, from the left edge of a canvas to the right one. */
function plot(canvas, curves) {
  const context = canvas.getContext("2d");
  canvas.width = canvas.clientWidth * devicePixelRatio;
  canvas.height = canvas.clientHeight * devicePixelRatio;
  const most = Math.max(...curves.flatMap(([shares]) => shares)) || 1;
  const style = getComputedStyle(document.documentElement);
  for (const [shares, color] of curves) {
    const wide = canvas.width / shares.length;
    context.strokeStyle = style.getPropertyValue(color);
    context.lineWidth = 1.5 * devicePixelRatio;
    context.beginPath();
    shares.forEach((share, k) => {
      const y = canvas.height - 1 - (share / most) * (canvas.height - 4);
      context.lineTo(k * wide, y);
      context.lineTo((k + 1) * wide, y);
    });
    context.stroke();
  }
}
