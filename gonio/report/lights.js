// The 81 lights from above: a click or the left and right arrow keys choose one.
function setUpLights() {
  const lights = $("lights"), measured = new Set(Array.from(samples.pair, pair => Math.floor(pair / COUNT)));
  for (const theta of [30, 60, 90]) {
    drawn(lights, "circle", { r: theta, class: "ring" });
    drawn(lights, "text", { x: theta - 1, y: -2, "text-anchor": "end" }, `${theta}°`);
  }
  const places = directions.map((_, i) => drawn(lights, "circle", {
    cx: told.theta[i] * Math.cos(told.phi[i] * RADIAN), cy: -told.theta[i] * Math.sin(told.phi[i] * RADIAN), r: 3.6,
  }));
  lights.addEventListener("click", event => {
    const { x, y } = new DOMPoint(event.clientX, event.clientY).matrixTransform(lights.getScreenCTM().inverse());
    const theta = Math.min(Math.hypot(x, y), 75);
    choose(nearest(direction(theta, Math.atan2(-y, x) / RADIAN)), chosen.view);
  });
  lights.addEventListener("keydown", event => {
    const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!step) return;
    event.preventDefault();
    choose((chosen.light + step + COUNT) % COUNT, chosen.view);
  });
  watchers.push(() => places.forEach((place, i) =>
    place.setAttribute("class", `place${measured.has(i) ? " measured" : ""}${i === chosen.light ? " chosen" : ""}`)));
}
