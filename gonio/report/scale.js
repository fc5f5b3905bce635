// How long a value is drawn: as a share of the light's largest, or over three decades below that.
const DECADES = 3;
const isLog = () => picked("scale").value === "log";
const most = (name, light, count) => {
  let largest = 0;
  for (let i = light * count; i < (light + 1) * count; i++) largest = Math.max(largest, fanValue(name, i));
  return largest;
};
const lobeMost = light => most("lobe", light, told.fans.rings[0] * told.fans.azimuths[0]);
const sliceMost = light => Math.max(most("high", light, told.fans.steps[0]), most("slice", light, 3 * told.fans.steps[0]));
const reach = (value, longest) => isLog()
  ? Math.max(1 + Math.log10(Math.max(value, 1e-30) / longest) / DECADES, 0) : Math.max(value / longest, 0);

// values at which rings are drawn: round shares of the largest
function marks(longest) {
  if (isLog()) return [0, 1, 2].map(decade => longest / 10 ** decade);
  const power = 10 ** Math.floor(Math.log10(longest)), share = longest / power;
  const step = power * (share > 5 ? 2 : share > 2 ? 1 : 0.5);
  return Array.from({ length: Math.floor(longest / step) }, (_, i) => (i + 1) * step);
}

// the mean of the channels of the samples at a light: [view, value]
const samplesOf = light => Array.from(samples.pair.entries()).filter(([, pair]) => Math.floor(pair / COUNT) === light)
  .map(([row, pair]) => [pair % COUNT, (samples.value[3 * row] + samples.value[3 * row + 1] + samples.value[3 * row + 2]) / 3]);

// the mean of the channels of the model at a pair of the grid
const meanAt = (light, view) => [0, 1, 2].reduce((sum, channel) => sum + grid.values[3 * (COUNT * light + view) + channel], 0) / 3;
