// What a step gives to the operation, service or workflow that it invokes: for each input a value of the run, or one of its own.
import type { Source } from "../cawl/called";
import type { Invoke, Variable } from "../cawl/document";
import { words } from "../cawl/names";
import { termWords } from "../cawl/phrases";
import { isText, shownValue, writtenValue } from "../cawl/values";
import { Combo, type Choice } from "../ui/combo";
import { toast } from "../ui/toasts";
import type { PaletteEntry } from "../flow/palette_data";
import { ofClass, type Vocabulary } from "../facts/vocabulary";

type Input = PaletteEntry["inputs"][number];

// `source`: where the variable of an input's name has its value from, where that is known.
export function Inputs(props: {
  entry: PaletteEntry;
  invoke: Invoke;
  variables: readonly Variable[];
  vocabulary: Vocabulary;
  short: (iri: string) => string;
  source?: (input: Input) => Source;
  onSet: (input: Input, expression: string) => void;
}) {
  const { entry, invoke, variables } = props;
  return (
    <div className="invoke-inputs">
      {entry.inputs.map((input) => {
        const known = variables.find((v) => v.name === input.name);
        const own = invoke.inputs.find((i) => i.part === input.name)?.expression;
        const set = (typed: string) => {
          try {
            const expression = writtenValue(typed, input.type);
            props.onSet(input, expression === `$${input.name}` ? "" : expression);
          } catch (error) {
            toast("bad", `${words(input.name)} stays as it was`, error instanceof Error ? error.message : "");
          }
        };
        const source = own === undefined ? props.source?.(input) : undefined;
        const lacks = source?.from === "none" && !input.optional;
        const label = input.name === "text" ? `Text to ${words(entry.id).toLowerCase()}` : words(input.name);
        return (
          <label key={input.name} className="property">
            <span>{label}</span>
            <Combo
              label={label}
              value={
                own === undefined
                  ? known && !lacks && !isText(input)
                    ? `$${input.name}`
                    : ""
                  : shownValue(own)
              }
              choices={choicesOf(input, props)}
              onChange={set}
              text={isText(input)}
              placeholder={
                lacks
                  ? "nothing gives it a value"
                  : known?.initial
                    ? shownValue(known.initial)
                    : known
                      ? `$${input.name}, as the run has it`
                      : input.optional
                        ? "any"
                        : isText(input)
                          ? "write the text"
                          : "choose one"
              }
            />
            {source && (
              <small className={lacks ? "input-lacks" : "faint"}>{sourceWords(source, input)}</small>
            )}
          </label>
        );
      })}
    </div>
  );
}

function sourceWords(source: Source, input: Input): string {
  switch (source.from) {
    case "initial":
      return `The run begins with ${termWords(source.value)}`;
    case "activator":
      return "Found by the situation that starts the run";
    case "start":
      return input.optional
        ? "One that is free, where the start gives none"
        : "Given at the start of the run";
    case "step":
      return `Found at ${source.step}`;
    case "none":
      return input.optional ? "One that is free" : input.matched ? "Any that fits is taken" : "It has none";
  }
}

function choicesOf(
  input: Input,
  props: { variables: readonly Variable[]; vocabulary: Vocabulary; short: (iri: string) => string },
): Choice[] {
  const type = props.short(input.type);
  const own = props.variables
    .filter((v) => v.name !== input.name && (!type || !v.type || v.type === type))
    .map((v): Choice => ({ value: `$${v.name}`, label: v.type, group: "Values of the run" }));
  const same: Choice = { value: `$${input.name}`, label: "as the run has it", group: "Values of the run" };
  const things =
    isText(input) || type.startsWith("xsd:")
      ? []
      : ofClass(props.vocabulary, type).map((w): Choice => ({
          value: w.term,
          label: w.label || w.use,
          use: w.use,
          group: "In the graph now",
        }));
  return [same, ...own, ...things];
}
