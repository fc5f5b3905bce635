// The lobe of the chosen light in three dimensions: facets from far to near, turned by drag or keys.
function setUpLobe() {
  const lobe = $("lobe"), { rings: [rings, ringDeg], azimuths: [around, aroundDeg] } = told.fans;
  let yaw = -0.5, pitch = 0.42;
  const ground = drawn(lobe, "path", { class: "ground" }), lightLine = drawn(lobe, "path", { class: "light" });
  const facets = Array.from({ length: (rings - 1) * around }, () => drawn(lobe, "polygon", {}));
  const over = drawn(lobe, "g", {});

  // to the right, down, and towards the eye
  const project = ([x, y, z]) => {
    const [right, away] = [x * Math.cos(yaw) - y * Math.sin(yaw), x * Math.sin(yaw) + y * Math.cos(yaw)];
    const up = z * Math.cos(pitch) + away * Math.sin(pitch);
    return [100 * right, 50 * Math.cos(pitch) - 8 - 100 * up, z * Math.sin(pitch) - away * Math.cos(pitch)];
  };
  const flat = points => points.map(([x, y]) => `${x.toFixed(1)},${y.toFixed(1)}`).join(" ");
  const times = (vector, by) => vector.map(each => by * each);

  function vertices(light, longest) {
    return Array.from({ length: rings * around }, (_, i) => {
      const [ring, azimuth] = [Math.floor(i / around), i % around];
      const at = direction(ring * ringDeg, told.phi[light] + azimuth * aroundDeg), index = light * rings * around + i;
      return { at: times(at, reach(fanValue("lobe", index), longest)), unsure: fanShare("relative", index) };
    });
  }
  // four corners a facet, ring by ring
  const sidesOf = corners => facets.map((_, i) => {
    const [ring, azimuth, next] = [Math.floor(i / around), i % around, (i + 1) % around], low = ring * around, high = low + around;
    return [corners[low + azimuth], corners[low + next], corners[high + next], corners[high + azimuth]];
  });
  const depth = side => side.reduce((sum, { seen }) => sum + seen[2], 0);

  function draw() {
    const { light, view } = chosen, longest = lobeMost(light);
    const corners = vertices(light, longest).map(each => ({ ...each, seen: project(each.at) }));
    ground.setAttribute("d", groundPath(project));
    lightLine.setAttribute("d", `M${flat([project([0, 0, 0])])}L${flat([project(times(directions[light], 1.12))])}`);
    sidesOf(corners).sort((a, b) => depth(a) - depth(b)).forEach((side, i) => {
      facets[i].setAttribute("points", flat(side.map(each => each.seen)));
      facets[i].setAttribute("fill", shade(side));
    });
    over.replaceChildren();
    for (const [at, value] of samplesOf(light)) mark(times(directions[at], reach(value, longest)), "sample", 1.8);
    mark(times(directions[view], reach(meanAt(light, view), longest)), "view", 3.6);
    const [x, y] = project(times(directions[light], 1.17));
    drawn(over, "text", { x, y: y + 2, "text-anchor": "middle" }, "light");
  }
  function mark(at, kind, r) {
    const [cx, cy, near] = project(at);
    drawn(over, "circle", { cx, cy, r, class: near < 0 ? `${kind} behind` : kind });
  }
  function turn(right, up) {
    yaw += right; pitch = Math.min(Math.max(pitch + up, 0), 1.3);
    draw();
  }
  let held = null;
  lobe.addEventListener("pointerdown", event => { lobe.setPointerCapture(event.pointerId); held = event; });
  lobe.addEventListener("pointermove", event => {
    if (!held || !event.buttons) return;
    turn((event.clientX - held.clientX) / 120, (event.clientY - held.clientY) / 120);
    held = event;
  });
  lobe.addEventListener("keydown", event => {
    const step = { ArrowUp: [0, 0.1], ArrowDown: [0, -0.1], ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0] }[event.key];
    if (step) { event.preventDefault(); turn(...step); }
  });
  watchers.push(draw);
}

// horizon, 45° and the marked edge
function groundPath(project) {
  const ring = radius => Array.from({ length: 73 }, (_, i) => direction(90, 5 * i).map(each => radius * each))
    .map((at, i) => `${i ? "L" : "M"}${project(at).slice(0, 2).map(each => each.toFixed(1)).join(" ")}`).join("");
  const spoke = (from, to) => `M${project(from).slice(0, 2).join(" ")}L${project(to).slice(0, 2).join(" ")}`;
  return ring(1) + ring(0.5) + spoke([-1, 0, 0], [1.1, 0, 0]) + spoke([0, -1, 0], [0, 1, 0]);
}

// from sure to unsure, darker where the facet looks away from a lamp at the upper left
const ends = told.unsure.colors.map(color => [1, 3, 5].map(at => parseInt(color.slice(at, at + 2), 16)));
function shade(side) {
  const unsure = side.reduce((sum, each) => sum + each.unsure, 0) / 4 / told.unsure.most;
  const place = Math.min(Math.max(unsure, 0), 1) * (ends.length - 1), low = Math.min(Math.floor(place), ends.length - 2);
  const [a, , b] = side.map(each => each.at), c = side[3].at, d = side[1].at;
  const [u, v] = [[0, 1, 2].map(i => b[i] - a[i]), [0, 1, 2].map(i => c[i] - d[i])];
  const normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
  const facing = Math.abs(dot(normal, [-0.4, -0.5, 0.77])) / (Math.hypot(...normal) || 1);
  const mixed = ends[low].map((each, i) => each + (place - low) * (ends[low + 1][i] - each));
  return `rgb(${mixed.map(each => Math.round(each * (0.6 + 0.4 * facing))).join(",")})`;
}
