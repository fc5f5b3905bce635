// The 81 x 81 map: pointing tells a pair, a click or the arrow keys choose it.
function setUpMap() {
  const map = $("map");
  drawRings($("map-rings"));
  const pairAt = event => {
    const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(map.getScreenCTM().inverse());
    const [light, view] = [Math.floor(at.y), Math.floor(at.x)];
    return Math.min(light, view) >= 0 && Math.max(light, view) < COUNT ? [light, view] : null;
  };
  map.addEventListener("pointermove", event => {
    const [light, view] = pairAt(event) || [chosen.light, chosen.view];
    tell(light, view);
  });
  map.addEventListener("pointerleave", () => tell(chosen.light, chosen.view));
  map.addEventListener("click", event => { const pair = pairAt(event); if (pair) choose(...pair); });
  map.addEventListener("keydown", event => {
    const step = { ArrowUp: [-1, 0], ArrowDown: [1, 0], ArrowLeft: [0, -1], ArrowRight: [0, 1] }[event.key];
    if (!step) return;
    event.preventDefault();
    const within = index => Math.min(Math.max(index, 0), COUNT - 1);
    choose(within(chosen.light + step[0]), within(chosen.view + step[1]));
  });
  for (const input of document.querySelectorAll('input[name="layer"]')) input.addEventListener("change", showLayer);
  watchers.push(() => {
    $("map-row").setAttribute("y", chosen.light);
    $("map-cell").setAttribute("x", chosen.view); $("map-cell").setAttribute("y", chosen.light);
    tell(chosen.light, chosen.view);
  });
}

function showLayer() {
  const input = picked("layer");
  $("map-picture").setAttribute("href", input.parentElement.querySelector("img").src);
  $("map-caption").textContent = input.dataset.caption;
  $("unsure").hidden = !input.dataset.end;
  $("unsure-end").textContent = input.dataset.end;
}

function drawRings(group) {
  for (let first = 0; first < COUNT;) {
    const theta = told.theta[first], count = told.theta.filter(each => each === theta).length;
    const middle = first + count / 2;
    // the pole's column is too narrow for its label beside the next
    drawn(group, "text", { x: middle + (first ? 0.4 : 0), y: 84.6, "text-anchor": first ? "middle" : "end" }, `${theta}°`);
    drawn(group, "text", { x: -0.9, y: middle + 1, "text-anchor": "end" }, `${theta}°`);
    if (first) drawn(group, "path", { d: `M${first} 81v1.2M0 ${first}h-1.2` });
    first += count;
  }
}

// what is known of a pair: the model, its band, and what was measured or is true
function tell(light, view) {
  const pair = COUNT * light + view, row = sampleAt.get(pair), truth = grid.truth;
  $("pair").textContent = `Light ${angles(light)}; view ${angles(view)}`;
  $("pair-kind").textContent = row === undefined ? "filled in"
    : samples.off_deg[row] < 0.5 ? "measured" : `measured ${degrees(samples.off_deg[row])} away`;
  $("more-head").textContent = row !== undefined ? "measured ± σ" : truth ? "truth" : "";
  const lines = told.channels.map((name, channel) => {
    const at = 3 * pair + channel, { values, sigma, lo, hi } = grid;
    const more = row !== undefined ? withSigma(samples.value[3 * row + channel], samples.sigma[3 * row + channel])
      : truth ? truth[at].toFixed(decimals(sigma[at], values[at])) : "";
    const digits = decimals(sigma[at], values[at]);
    return [name, withSigma(values[at], sigma[at]), `${lo[at].toFixed(digits)} to\u00a0${hi[at].toFixed(digits)}`, more];
  });
  $("values").replaceChildren(...lines.map(line));
}

function line([name, ...cells]) {
  const row = document.createElement("tr"), head = document.createElement("th");
  head.scope = "row"; head.textContent = name;
  row.append(head);
  for (const text of cells) row.insertCell().textContent = text;
  return row;
}
