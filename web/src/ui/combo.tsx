// A text field that offers values while somebody types; any text may be typed. It is done by Enter, Tab or leaving it. The name of an
// offer is that offer, and Enter takes the only one that is left.
import { useEffect, useId, useLayoutEffect, useMemo, useRef, useState } from "react";
import { createPortal } from "react-dom";
import { score } from "./picker";
import "./combo.css";

export interface Choice {
  value: string;
  label?: string;
  use?: string;
  group?: string;
  words?: string; // further words that find it
}

// What somebody means who typed this: a value as the language writes it, the name of an offer, or with `only` the only offer that
// is left. `left`: those that what was typed finds.
export function meant(
  typed: string,
  choices: readonly Choice[],
  left: readonly Choice[],
  only: boolean,
): string {
  const text = typed.trim();
  if (text === "" || choices.some((c) => c.value === text)) return text;
  const plain = text.toLowerCase();
  const called = choices.filter(
    (c) =>
      c.value.replace(/^(?:[\w-]+:|\$)/, "").toLowerCase() === plain ||
      (c.label !== c.use && c.label?.toLowerCase() === plain),
  );
  if (called.length === 1 && called[0]) return called[0].value;
  const exact = called.filter((c) => c.value.replace(/^[\w-]+:/, "") === text);
  if (exact.length === 1 && exact[0]) return exact[0].value;
  return only && left.length === 1 && left[0] && !written.test(text) ? left[0].value : text;
}
// The offers that what was typed finds, the best first.
export function found(choices: readonly Choice[], typed: string): Choice[] {
  return choices
    .map((choice) => ({
      choice,
      score: score(
        {
          title: `${choice.value.replace(/^[\w-]+:/, "")} ${choice.label ?? ""}`,
          words: `${choice.value} ${choice.words ?? ""}`,
        },
        typed,
      ),
    }))
    .filter((entry) => entry.score > 0)
    .sort((a, b) => b.score - a.score)
    .map((entry) => entry.choice);
}
// A variable, a number, a text in quotes, a comparison, a term with its prefix.
const written = /^(?:[?$"'<>=!+-]|\d|true$|false$|[A-Za-z][\w-]*:)/;

export function Combo(props: {
  value: string;
  label: string;
  placeholder?: string;
  choices: readonly Choice[];
  onChange: (value: string) => void;
  className?: string;
  disabled?: boolean;
  autoFocus?: boolean;
  text?: boolean; // words that are meant as they are typed
  live?: boolean; // tells of each key, and not only of what is done
}) {
  const [typed, setTyped] = useState(props.value);
  const [open, setOpen] = useState(false);
  const [active, setActive] = useState(-1);
  const [changed, setChanged] = useState(false);
  const input = useRef<HTMLInputElement>(null);
  const list = useRef<HTMLDivElement>(null);
  const id = useId();
  useEffect(() => setTyped(props.value), [props.value]);
  const shown = useMemo(
    () => (!open ? [] : !changed ? props.choices.slice(0, 60) : found(props.choices, typed).slice(0, 60)),
    [open, changed, typed, props.choices],
  );

  const [place, setPlace] = useState<React.CSSProperties>({});
  useLayoutEffect(() => {
    if (!open || !input.current) return;
    const box = input.current.getBoundingClientRect();
    const foot = input.current.closest("dialog")?.querySelector(".sheet-foot")?.getBoundingClientRect().top; // its buttons stay seen
    const below = (foot ?? window.innerHeight) - box.bottom;
    const width = Math.max(box.width, 250);
    const left = Math.min(box.left, window.innerWidth - width - 8);
    setPlace(
      below > 240 || below > box.top
        ? { left, width, top: box.bottom + 3, maxHeight: Math.min(260, below - 12) }
        : { left, width, bottom: window.innerHeight - box.top + 3, maxHeight: Math.min(260, box.top - 12) },
    );
  }, [open, shown.length]);
  useEffect(
    () => void list.current?.querySelector('[aria-selected="true"]')?.scrollIntoView({ block: "nearest" }),
    [active],
  );

  // What is typed, when it is done; what was not typed in stays as it is.
  const done = (only: boolean) =>
    changed && !props.text
      ? meant(typed, props.choices, only ? found(props.choices, typed) : [], only)
      : typed.trim();
  const finish = (value: string) => {
    setOpen(false);
    setActive(-1);
    setChanged(false);
    setTyped(value);
    if (value !== props.value) props.onChange(value);
  };
  const keys = (event: React.KeyboardEvent) => {
    if (event.key === "ArrowDown" || event.key === "ArrowUp") {
      event.preventDefault();
      if (!open) return setOpen(true);
      const step = event.key === "ArrowDown" ? 1 : -1;
      setActive((at) => (at + step + shown.length) % Math.max(1, shown.length));
    } else if (event.key === "Enter") {
      if (event.nativeEvent.isComposing) return;
      event.preventDefault();
      finish(shown[active]?.value ?? done(true));
    } else if (event.key === "Escape") {
      if (!open && typed === props.value) return;
      event.preventDefault();
      event.stopPropagation();
      setTyped(props.value);
      setOpen(false);
      setChanged(false);
    } else if (event.key === "Tab") finish(shown[active]?.value ?? done(false));
  };
  return (
    <>
      <input
        ref={input}
        className={`field small ${props.className ?? ""}`}
        role="combobox"
        aria-expanded={open}
        aria-controls={id}
        aria-autocomplete="list"
        aria-label={props.label}
        title={props.label}
        aria-activedescendant={active >= 0 ? `${id}-${active}` : undefined}
        value={typed}
        placeholder={props.placeholder}
        disabled={props.disabled}
        spellCheck={false}
        autoComplete="off"
        autoFocus={props.autoFocus}
        onChange={(e) => (
          setTyped(e.target.value),
          setChanged(true),
          setOpen(true),
          setActive(-1),
          props.live && props.onChange(e.target.value)
        )}
        onFocus={(e) => e.target.select()}
        onClick={() => setOpen(true)}
        onKeyDown={keys}
        onBlur={() => finish(done(false))}
      />
      {open &&
        shown.length > 0 &&
        createPortal(
          <div
            className="combo-list"
            role="listbox"
            id={id}
            aria-label={props.label}
            ref={list}
            style={place}
            onMouseDown={(e) => e.preventDefault()}
          >
            {shown.map((choice, i) => (
              <div key={choice.value} role="presentation">
                {!changed && choice.group && choice.group !== shown[i - 1]?.group && (
                  <div className="combo-group" role="presentation">
                    {choice.group}
                  </div>
                )}
                <div
                  id={`${id}-${i}`}
                  role="option"
                  aria-selected={i === active}
                  className="combo-item"
                  onMouseMove={() => i !== active && setActive(i)}
                  onClick={() => finish(choice.value)}
                >
                  <span className="mono cut">{choice.value}</span>
                  <span className="combo-use cut">
                    {choice.label &&
                    choice.label.toLowerCase() !== choice.value.replace(/^[\w-]+:/, "").toLowerCase()
                      ? choice.label
                      : choice.use}
                  </span>
                </div>
              </div>
            ))}
          </div>,
          input.current?.closest("dialog") ?? document.body, // a modal dialog lies above all else of the page
        )}
    </>
  );
}
