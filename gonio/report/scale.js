// How long a value is drawn: as a share of the light's largest, or over three decades below that.
const DECADES = 3;
const isLog = () => picked("scale").value === "log";
const longest = light => {
  let most = 0;
  const { rings: [rings], azimuths: [around], steps: [steps] } = told.fans;
  for (let i = 0; i < rings * around; i++) most = Math.max(most, fanValue("lobe", light * rings * around + i));
  for (let i = 0; i < steps; i++) most = Math.max(most, fanValue("high", light * steps + i));
  return most;
};
const reach = (value, most) => isLog()
  ? Math.max(1 + Math.log10(Math.max(value, 1e-30) / most) / DECADES, 0) : Math.max(value / most, 0);

// values at which rings are drawn: round shares of the largest
function marks(most) {
  if (isLog()) return [0, 1, 2].map(decade => most / 10 ** decade);
  const step = 10 ** Math.floor(Math.log10(most)), by = most / step > 5 ? 2 : most / step > 2 ? 1 : 0.5;
  const values = [];
  for (let value = by * step; value <= most * 1.0001; value += by * step) values.push(value);
  return values;
}

// the mean of the channels of the samples at a light: [view, value]
const samplesOf = light => Array.from(samples.pair.entries()).filter(([, pair]) => Math.floor(pair / COUNT) === light)
  .map(([row, pair]) => [pair % COUNT, (samples.value[3 * row] + samples.value[3 * row + 1] + samples.value[3 * row + 2]) / 3]);

// the mean of the channels of the model at a pair of the grid
const meanAt = (light, view) => [0, 1, 2].reduce((sum, channel) => sum + grid.values[3 * (COUNT * light + view) + channel], 0) / 3;
