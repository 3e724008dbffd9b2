import { keyLabels } from "./commands";

export function Keys({ keys }: { keys: string }) {
  return (
    <span className="row" style={{ gap: "var(--space-1)" }} aria-hidden>
      {keyLabels(keys).map((key, i) => (
        <kbd key={i}>{key}</kbd>
      ))}
    </span>
  );
}
