// Everything is set up, and a light that was measured at about 45° is chosen, with its mirrored view.
setUpMap(); setUpLobe(); setUpSlice(); setUpLights();
$("lobe-end").textContent = `${Number((100 * told.unsure.most).toPrecision(2))} %`;
for (const input of document.querySelectorAll('input[name="scale"]')) input.addEventListener("change", () => choose(chosen.light, chosen.view));

const oblique = light => Math.abs(told.theta[light] - 45);
const lit = Array.from(samples.pair, pair => Math.floor(pair / COUNT)).sort((a, b) => a - b);
const first = (lit.length ? lit : Array.from(directions.keys())).reduce((best, light) => oblique(light) < oblique(best) ? light : best);
// a highlight far above the body would leave nothing else to be seen
const body = Array.from(grid.values).sort((a, b) => a - b)[Math.floor(grid.values.length / 2)];
if (lobeMost(first) > 30 * body) document.querySelector('input[name="scale"][value="log"]').checked = true;
choose(first, nearest(direction(told.theta[first], told.phi[first] + 180)));
