// The plane of incidence of the chosen light: mean with its band, channels, truth and samples.
function setUpSlice() {
  const slice = $("slice"), [steps, stepDeg] = told.fans.steps, middle = (steps - 1) / 2;
  const place = (angle, value, longest) => {
    const r = 100 * reach(value, longest);
    return `${(r * Math.sin(angle * RADIAN)).toFixed(1)} ${(-r * Math.cos(angle * RADIAN)).toFixed(1)}`;
  };
  const angle = step => (step - middle) * stepDeg;
  const each = point => Array.from({ length: steps }, (_, step) => point(step));
  const path = points => "M" + points.join("L");

  function draw() {
    const { light } = chosen, longest = sliceMost(light), at = step => light * steps + step;
    const along = (name, stride = 1, channel = 0) =>
      each(step => place(angle(step), fanValue(name, stride * at(step) + channel), longest));
    slice.replaceChildren();
    backdrop(slice, longest);
    drawn(slice, "path", { class: "band", d: path([...along("low"), ...along("high").reverse()]) + "Z" });
    if (told.channels.length === 3) ["red", "green", "blue"].forEach((name, channel) =>
      drawn(slice, "path", { class: `channel ${name}`, d: path(along("slice", 3, channel)) }));
    if (fans.truth) drawn(slice, "path", { class: "truth", d: path(along("truth")) });
    drawn(slice, "path", { class: "mean", d: path(each(step => place(angle(step), mean(at(step)), longest))) });
    drawn(slice, "path", { class: "light", d: path(["0 0", polar(-told.theta[light], 104)]) });
    for (const [view, value] of samplesOf(light)) {
      const seen = inPlane(light, view);
      if (seen === null) continue;
      const [cx, cy] = place(seen, value, longest).split(" ");
      drawn(slice, "circle", { cx, cy, r: 2, class: "sample" });
    }
    const seen = inPlane(light, chosen.view);
    if (seen !== null) {
      const [cx, cy] = place(seen, meanAt(light, chosen.view), longest).split(" ");
      drawn(slice, "circle", { cx, cy, r: 3.6, class: "view" });
    }
    $("slice-told").textContent = `Light ${angles(light)}. Point at the slice for a value.`;
  }
  slice.addEventListener("pointermove", event => {
    const to = new DOMPoint(event.clientX, event.clientY).matrixTransform(slice.getScreenCTM().inverse());
    const step = Math.round(Math.atan2(to.x, -to.y) / RADIAN / stepDeg) + middle;
    if (step < 0 || step >= steps) return;
    const at = chosen.light * steps + step;
    $("slice-told").textContent = `View ${degrees(angle(step))}: ${round(mean(at))} 1/sr, ` +
      `5 to 95 %: ${round(fanValue("low", at))} to ${round(fanValue("high", at))}`;
  });
  watchers.push(draw);
}

const mean = at => [0, 1, 2].reduce((sum, channel) => sum + fanValue("slice", 3 * at + channel), 0) / 3;
const polar = (angle, r) => `${(r * Math.sin(angle * RADIAN)).toFixed(1)} ${(-r * Math.cos(angle * RADIAN)).toFixed(1)}`;

// the view's angle in the plane of incidence, positive away from the light; null outside of it
function inPlane(light, view) {
  const phi = told.phi[light] * RADIAN, [x, y, z] = directions[view];
  const [away, across] = [-x * Math.cos(phi) - y * Math.sin(phi), x * Math.sin(phi) - y * Math.cos(phi)];
  return Math.abs(across) < Math.sin(RADIAN) ? Math.atan2(away, z) / RADIAN : null;
}

function backdrop(slice, longest) {
  for (const value of marks(longest)) {
    const r = 100 * reach(value, longest);
    drawn(slice, "path", { class: "ring", d: `M${-r} 0A${r} ${r} 0 0 1 ${r} 0` });
    drawn(slice, "text", { x: r, y: 8, "text-anchor": "middle" }, String(Number(value.toPrecision(2))));
  }
  for (let angle = -90; angle <= 90; angle += 30) {
    drawn(slice, "path", { class: "ring", d: `M0 0L${polar(angle, 100)}` });
    if (Math.abs(angle) < 90) {
      const [x, y] = polar(angle, 108).split(" ");
      drawn(slice, "text", { x, y: Number(y) + 2, "text-anchor": "middle" }, `${angle}°`);
    }
  }
  drawn(slice, "text", { x: -100, y: 8, "text-anchor": "middle" }, "light");
  drawn(slice, "text", { x: 0, y: 19, "text-anchor": "middle" }, "1/sr");
}
