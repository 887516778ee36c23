/* The controls above the panes, keys that work everywhere, and the start. */

function showSettings() {
  const limit = formatPercent(tolerance * 2 ** state.limit).slice(1);
  element("exposure").disabled = state.display === "scene";
  element("exposure-value").textContent = state.display === "scene" ? "the scene's" : `${state.exposure > 0 ? "+" : ""}${state.exposure} EV`;
  element("limit-value").textContent = `± ${limit}`;
  element("scale-ends").textContent = `relative difference, −${limit} to +${limit}`;
  element("false-scale").hidden = state.display !== "false";
}

function change(key, value) {
  state[key] = value;
  // The scene's view is a finished picture; one channel of it, or another exposure, is shown without it.
  if (key === "channel" && value !== "rgb" && state.display === "scene") state.display = "standard";
  if (key === "display" && value === "scene") state.channel = "rgb";
  for (const id of ["display", "channel", "exposure", "limit"]) element(id).value = state[id];
  showSettings();
  repaint();
  draw();
}

function setMode(mode) {
  if (state.pass >= 0 && WHOLE_ONLY.includes(mode)) return;
  state.mode = mode;
  layOut();
}

for (const button of document.querySelectorAll("[data-mode]")) button.addEventListener("click", () => setMode(button.dataset.mode));
for (const key of ["exposure", "limit"]) element(key).addEventListener("input", (event) => change(key, Number(event.target.value)));
for (const key of ["display", "channel"]) element(key).addEventListener("input", (event) => change(key, event.target.value));
for (const [id, factor] of [["closer", 1.5], ["farther", 1 / 1.5]]) {
  element(id).addEventListener("click", () => zoomBy(factor, panes[0].canvas.width / 2, panes[0].canvas.height / 2));
}
element("fit").addEventListener("click", fit);
element("previous").addEventListener("click", () => chooseNext(-1));
element("next").addEventListener("click", () => chooseNext(1));
element("histograms").addEventListener("toggle", drawHistograms);
window.addEventListener("resize", fit);

document.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || event.target.matches("input, select, textarea")) return;
  if (MODES[Number(event.key) - 1]) setMode(MODES[Number(event.key) - 1]);
  else if (event.key === "n") chooseNext(1);
  else if (event.key === "p") chooseNext(-1);
});

for (const part of document.querySelectorAll("[data-script]")) part.hidden = false;
element("static-note").remove();
for (const id of ["display", "channel", "exposure", "limit"]) element(id).value = state[id];
showSettings();
fillOutcomes();
element("outcome").value = counts.EQUIVALENT < regions.length ? "open" : "";
layOut();
fill();
if (readHash(location.hash, regions)) follow();
else {
  state.chosen = filtered().filter((region) => region.outcome !== "EQUIVALENT").slice(0, 1);
  markChosen();
  draw();
}
document.documentElement.dataset.ready = "";
