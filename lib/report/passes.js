/* Light passes: one of them in place of the whole image, and all of them at the pixel that is pointed at. */

const ERRORS = ["errors-0", "errors-1"];
const whole = { reference, candidate, significances, errors: view.passes.length ? await Promise.all(ERRORS.map(unpack)) : [] };
const WHOLE_ONLY = ["map", "eye"];

/* Means of several pixels, as many values as the page has pixels. */
function spread(values, make) {
  const times = view.passStep / step;
  if (times === 1) return values;
  const across = Math.ceil((width * step) / view.passStep);
  const found = new make(3 * width * height);
  for (let y = 0; y < height; y++) {
    for (let x = 0; x < width; x++) {
      const from = 3 * (Math.floor(y / times) * across + Math.floor(x / times));
      for (let c = 0; c < 3; c++) found[3 * (y * width + x) + c] = values[from + c];
    }
  }
  return found;
}

const lights = await Promise.all(view.passes.map(async (_, k) => {
  const [first, second, codes, ...errors] = await Promise.all(
    ["floats-0", "floats-1", "significance", ...ERRORS].map((name) => unpack(`pass-${k}-${name}`)));
  return {
    reference: spread(joinBytes(first), Float32Array),
    candidate: spread(joinBytes(second), Float32Array),
    significances: spread(new Int8Array(codes.buffer), Int8Array),
    errors: errors.map((one) => spread(one, Uint8Array)),
  };
}));

/* Show pass number k, or the whole image for -1. */
function showPass(k) {
  if (!view.passes[k]) k = -1;
  state.pass = k;
  ({ reference, candidate, significances } = lights[k] ?? whole);
  if (k >= 0 && state.display === "scene") state.display = "standard";
  const scene = element("display").querySelector("[value=scene]");
  if (scene) scene.disabled = k >= 0;
  for (const button of document.querySelectorAll("[data-mode]")) button.disabled = k >= 0 && WHOLE_ONLY.includes(button.dataset.mode);
  if (k >= 0 && WHOLE_ONLY.includes(state.mode)) setMode("beside");
  element("pass").value = k;
  element("pass-note").hidden = k < 0;
  for (const row of element("pass-table").tBodies[0].rows) {
    row.hidden = k < 0 ? "quiet" in row.dataset : Number(row.dataset.pass) !== k;
  }
  change("exposure", k < 0 ? view.exposure : view.passes[k].exposure);
}

/* A standard error of its code (code_errors in pixels.py), as text. */
function decodeError(code) {
  if (code === view.error.none) return "?";
  return code === view.error.zero ? "0" : `${+(2 ** ((code - view.error.one) / view.error.steps)).toPrecision(1)}`;
}

/* The whole image and every pass that sends light through a pixel, one a row. */
function readPasses(i) {
  if (!view.passes.length) return;
  const three = (tell) => [0, 1, 2].map((c) => tell(i + c)).join("  ");
  const rows = [whole, ...lights].map((one, k) => {
    const values = [one.reference, one.candidate];
    if (k && ![0, 1, 2].some((c) => values.some((side) => side[i + c]))) return [];
    const lit = values.map((side, s) => three((at) => `${formatNumber(side[at])} ± ${decodeError(one.errors[s][at])}`));
    const off = three((at) => formatPercent(relativeDifference(values[1][at] - values[0][at], values[0][at], floor[at % 3])));
    const code = (at) => one.significances[at];
    const sigma = three((at) => (code(at) === view.significance.none ? "none" : (code(at) / view.significance.one).toFixed(1)));
    const row = document.createElement("tr");
    [k ? view.passes[k - 1].name : "all of it", ...lit, off, sigma].forEach((text, column) => {
      const cell = row.insertCell();
      cell.textContent = text;
      if (column) cell.className = "number";
    });
    return [row];
  });
  element("decomposition").querySelector("tbody").replaceChildren(...rows.flat());
}

if (view.passes.length) {
  element("pass").addEventListener("input", (event) => showPass(Number(event.target.value)));
  element("pass-shots").hidden = true;
  for (const link of element("pass-table").querySelectorAll("a")) {
    link.addEventListener("click", (event) => {
      event.preventDefault();
      showPass(Number(link.hash.slice("#pass-".length)));
      element("images").scrollIntoView({ block: "start" });
    });
  }
}
