// Fields for numbers. One that is empty or out of range shows the present value again, and a message says why.
//
// options: name (for screen readers), unit, low, high and digits in that unit, each (the unit in SI units), get and
// set (in SI units). `optional` fields may be empty: get and set take null then.
const numberFields = [];
function numberField(parent, options) {
  const input = added(parent, "input", { type: "number", step: "any" });
  input.setAttribute("aria-label", `${options.name} in ${options.unit}`);
  const show = () => { if (input !== document.activeElement) input.value = fieldText(options); };
  input.onchange = () => {
    const problem = fieldProblem(input, options);
    say("field", problem);
    const isEmpty = input.value === "" && !input.validity.badInput;
    if (!problem) options.set(isEmpty ? null : input.valueAsNumber * options.each);
    input.value = fieldText(options);
  };
  numberFields.push(show);
  show();
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
onChange(() => { for (const show of numberFields) show(); });

// A section of the panel that can be folded; its heading says what is chosen.
function foldable(id, title) {
  const box = added(byId(id), "details");
  const heading = added(box, "summary");
  added(heading, "b", { textContent: title });
  const said = added(heading, "span");
  return { box, say: (text) => { said.textContent = text; } };
}
