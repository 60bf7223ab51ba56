// The page's elements, texts, messages and fields for numbers.
import { onChange } from "./state.js";

export const byId = (id) => document.getElementById(id);
export const narrow = matchMedia("(max-width: 760px)");
export const dark = matchMedia("(prefers-color-scheme: dark)");
export const calm = matchMedia("(prefers-reduced-motion: reduce)");

// Add an element to another one, with some properties, and return it.
export function added(parent, tag, properties = {}) {
  return Object.assign(parent.appendChild(document.createElement(tag)), properties);
}
// Write a text, unless it is there already: a text that is written is laid out and painted again.
export function write(element, text) {
  if (element.textContent !== text) element.textContent = text;
}
// A number as text, with a true minus sign and without minus zero.
export function fixed(value, digits) {
  const text = value.toFixed(digits);
  return Number(text) === 0 ? (0).toFixed(digits) : text.replace("-", "\u2212");
}
export const mm = (metres) => fixed(1e3 * metres, 1);

// ---- messages, one for each subject
const messages = {};
export function say(matter, text) {
  if ((messages[matter] || "") === text) return;
  messages[matter] = text;
  byId("message").replaceChildren();
  for (const each of Object.values(messages).filter(Boolean)) added(byId("message"), "p", { textContent: each });
}

// ---- fields for numbers. One that is empty or out of range shows the present value again, and a message says why.
//
// options: name (for screen readers), unit, low, high and digits in that unit, each (the unit in SI units), get and
// set (in SI units). `optional` fields may be empty: get and set take null then.
export function numberField(parent, options) {
  const input = added(parent, "input", { type: "number", step: "any" });
  input.setAttribute("aria-label", `${options.name} in ${options.unit}`);
  input.onchange = () => {
    const problem = fieldProblem(input, options);
    say("field", problem);
    const isEmpty = input.value === "" && !input.validity.badInput;
    if (!problem) options.set(isEmpty ? null : input.valueAsNumber * options.each);
    input.value = fieldText(options);
  };
  onChange(() => { if (input !== document.activeElement) input.value = fieldText(options); });
  return input;
}
function fieldText({ get, each, digits }) {
  const value = get();
  return value === null ? "" : String(Number((value / each).toFixed(digits)));
}
function fieldProblem(input, { name, unit, low, high, optional }) {
  if (input.validity.badInput) return `${name} needs a number.`;
  if (input.value === "") return optional ? "" : `${name} needs a number.`;
  const value = input.valueAsNumber;
  if (value >= low && value <= high) return "";
  return `${name} cannot be ${asTyped(input)} ${unit}: it must lie between ${fixed(low, 0)} and ${fixed(high, 0)} ${unit}.`;
}
export const asTyped = (field) => (field.value.length < 12 ? field.value : field.valueAsNumber.toExponential(2)).replace("-", "\u2212");

// A section of the panel that can be folded; its heading says what is chosen.
export function foldable(id, title) {
  const box = added(byId(id), "details");
  const heading = added(box, "summary");
  added(heading, "b", { textContent: title });
  const said = added(heading, "span");
  return { box, say: (text) => write(said, text) };
}
