// What the page was given, unpacked; and the pair and the light that are chosen.
const $ = id => document.getElementById(id);
const told = JSON.parse($("data").textContent);
const COUNT = told.theta.length, RADIAN = Math.PI / 180;

const bytes = text => Uint8Array.from(atob(text), letter => letter.charCodeAt(0)).buffer;
const unpack = (texts, kind) => Object.fromEntries(Object.entries(texts)
  .filter(([, text]) => typeof text === "string").map(([name, text]) => [name, new kind(bytes(text))]));

const grid = unpack(told.grid, Float32Array);
const fans = unpack(told.fans, Uint16Array);
const { pair: pairs, ...measured } = told.samples;
const samples = { ...unpack(measured, Float32Array), pair: new Uint16Array(bytes(pairs)) };
const sampleAt = new Map(Array.from(samples.pair, (pair, row) => [pair, row]));

// the inverse of _logs in embedded.py
const [logMost, logSteps] = told.fans.log;
const fanShare = (name, index) => Math.exp((2 * fans[name][index] / logSteps - 1) * logMost);
const fanValue = (name, index) => told.fans.white * fanShare(name, index);

const direction = (theta, phi) => [Math.sin(theta * RADIAN) * Math.cos(phi * RADIAN),
  Math.sin(theta * RADIAN) * Math.sin(phi * RADIAN), Math.cos(theta * RADIAN)];
const directions = told.theta.map((theta, i) => direction(theta, told.phi[i]));
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const nearest = at => directions.reduce((best, each, i) => dot(each, at) > dot(directions[best], at) ? i : best, 0);

const degrees = angle => `${Number(angle.toFixed(1))}°`;
const angles = i => `θ ${degrees(told.theta[i])}` + (told.theta[i] ? `, φ ${degrees(told.phi[i])}` : "");

// a value as precise as its uncertainty is worth: two digits of that
function decimals(sigma, value) {
  const least = sigma > 0 ? sigma : Math.abs(value) / 100;
  return least > 0 ? Math.min(Math.max(1 - Math.floor(Math.log10(least)), 0), 12) : 3;
}
const withSigma = (value, sigma) => value.toFixed(decimals(sigma, value)) +
  (sigma >= 0 ? ` ±\u00a0${sigma.toFixed(decimals(sigma, value))}` : "");
const round = value => String(Number(value.toPrecision(3)));

function drawn(parent, name, attributes, text) {
  const made = document.createElementNS(parent.namespaceURI, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text !== undefined) made.textContent = text;
  return parent.appendChild(made);
}

const chosen = { light: 0, view: 0 }, watchers = [];
function choose(light, view) {
  chosen.light = light; chosen.view = view;
  for (const each of watchers) each();
}
const picked = name => document.querySelector(`input[name="${name}"]:checked`);
