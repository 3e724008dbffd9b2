// What can be done in the view that is open: the source of Ctrl-K, of the keys, and of the list of keys.
import { useEffect, useRef } from "react";
import { createStore } from "../api/store";

export interface Command {
  title: string;
  group: string;
  keys?: string; // "Mod+K", "Shift+F", "/", one after the other "G R", either "Delete|Backspace"; Mod is Ctrl, or Cmd on a Mac
  icon?: React.ComponentType<{ size?: number }>;
  words?: string; // further words that find it
  hidden?: boolean; // has a key, but is not offered in Ctrl-K
  inFields?: boolean; // its key works while somebody types, too
  onCanvas?: boolean; // its key is for what is selected on the canvas: not while the focus is in a panel, or text is selected
  run: () => void;
}

type Source = { current: readonly Command[] };
const sources = new Set<Source>();
const version = createStore(0);
const changed = () => version.set(version.get() + 1);

// Offers commands as long as the component is there.
export function useCommands(commands: readonly Command[]) {
  const source = useRef(commands);
  source.current = commands;
  useEffect(() => {
    sources.add(source);
    changed();
    return () => {
      sources.delete(source);
      changed();
    };
  }, []);
}

export function allCommands(): Command[] {
  return [...sources].reverse().flatMap((source) => [...source.current]);
}
export const useCommandsVersion = version.use;

export const isMac = /Mac|iPhone|iPad/.test(navigator.platform);
export function keyLabels(keys: string): string[] {
  return (keys.split("|")[0] ?? "")
    .split(/\+(?=.)| /)
    .map((key) =>
      key === "Mod" ? (isMac ? "⌘" : "Ctrl") : key === "Shift" ? "⇧" : key === "Delete" ? "Del" : key,
    );
}

function matches(keys: string, event: KeyboardEvent): boolean {
  const parts = keys.split(/\+(?=.)/); // "+" is a key, too
  const key = parts.at(-1) ?? "";
  const mod = parts.includes("Mod");
  if (mod !== (isMac ? event.metaKey : event.ctrlKey) || event.altKey) return false;
  if (/^[a-z]$/i.test(key))
    return event.key.toLowerCase() === key.toLowerCase() && event.shiftKey === parts.includes("Shift");
  return event.key === key && (key.length === 1 || event.shiftKey === parts.includes("Shift"));
}

function isField(target: EventTarget | null): boolean {
  return (
    target instanceof HTMLElement &&
    (target.isContentEditable || /^(INPUT|TEXTAREA|SELECT)$/.test(target.tagName))
  );
}

// The focus is on the canvas or nowhere, and no text is selected that the key would be meant for.
function isForCanvas(target: EventTarget | null): boolean {
  if (!(target instanceof HTMLElement || target instanceof SVGElement)) return true;
  if (target.closest(".canvas")) return true;
  return (
    (target === document.body || target === document.documentElement) &&
    (document.getSelection()?.isCollapsed ?? true)
  );
}

// The first key of a sequence, as long as the second may follow.
let pending: { event: KeyboardEvent; until: number } | null = null;

function hit(keys: string, event: KeyboardEvent): boolean {
  return keys.split("|").some((alternative) => {
    const [first = "", second] = alternative.split(" ");
    if (second === undefined) return pending === null && matches(first, event);
    return pending !== null && matches(first, pending.event) && matches(second, event);
  });
}

export function startKeys() {
  window.addEventListener("keydown", (event) => {
    if (event.defaultPrevented || event.isComposing) return;
    if (pending && Date.now() > pending.until) pending = null;
    const field = isField(event.target);
    const inDialog = event.target instanceof HTMLElement && event.target.closest("dialog") !== null;
    const commands = allCommands().filter(
      (c) => c.keys && (c.inFields || (!field && !inDialog)) && (!c.onCanvas || isForCanvas(event.target)),
    );
    const command = commands.find((c) => c.keys && hit(c.keys, event));
    const begins =
      !field &&
      !inDialog &&
      !pending &&
      commands.some((c) => c.keys?.includes(" ") && matches(c.keys.split(" ")[0] ?? "", event));
    pending = !command && begins ? { event, until: Date.now() + 1200 } : null;
    if (!command) return;
    event.preventDefault();
    command.run();
  });
}
