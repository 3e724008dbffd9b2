// The findings of the check: each leads to its place and offers its remedy.
import {
  ChevronDown,
  ChevronUp,
  CircleAlert,
  CircleCheck,
  LoaderCircle,
  TriangleAlert,
  Unplug,
  WandSparkles,
} from "lucide-react";
import type { Finding, Findings } from "./findings";
import "./findings.css";

export function FindingRow(props: {
  finding: Finding;
  onFix: (finding: Finding) => void;
  onJump: (finding: Finding) => void;
  place?: string;
}) {
  const { finding } = props;
  return (
    <li className={`finding ${finding.error ? "bad" : "wait"}`}>
      <button className="finding-words" onClick={() => props.onJump(finding)} title="Show the place">
        {finding.error ? (
          <CircleAlert size={14} aria-label="error" />
        ) : (
          <TriangleAlert size={14} aria-label="warning" />
        )}
        <span>
          {finding.message}
          {finding.hint && (
            <span className="finding-hint faint">
              {finding.hint.replace(/^[a-z](?=[a-z]*[ ,])/, (c) => c.toUpperCase())}
            </span>
          )}
        </span>
        {props.place && <span className="finding-place faint">{props.place}</span>}
      </button>
      {finding.fix.length > 0 && (
        <button className="button small" onClick={() => props.onFix(finding)}>
          <WandSparkles size={13} />
          {finding.remedy ?? "Mend it"}
        </button>
      )}
    </li>
  );
}

const shownAtOnce = 200;

export function FindingsPanel(props: {
  findings: Findings;
  lineOf: (offset: number) => number;
  open: boolean;
  onToggle: () => void;
  onFix: (finding: Finding) => void;
  onJump: (finding: Finding) => void;
}) {
  const { list, checking, error } = props.findings;
  const errors = list.filter((f) => f.error).length;
  const warnings = list.length - errors;
  const fixable = list.filter((f) => f.fix.length > 0).length;
  return (
    <section className="findings" aria-label="Findings">
      <button
        className="findings-bar"
        aria-expanded={props.open}
        onClick={props.onToggle}
        disabled={list.length === 0}
      >
        {list.length === 0 && !error && !checking && (
          <>
            <CircleCheck size={14} className="ok" />
            Nothing to mend
          </>
        )}
        {list.length === 0 && !error && checking && (
          <>
            <LoaderCircle size={14} className="turn" />
            Checking
          </>
        )}
        {list.length === 0 && error && (
          <>
            <Unplug size={14} />
            Not checked: {error.title.toLowerCase()}
          </>
        )}
        {errors > 0 && (
          <span className="row" style={{ gap: "var(--space-2)" }}>
            <CircleAlert size={14} className="bad" />
            {errors} to mend
          </span>
        )}
        {warnings > 0 && (
          <span className="row" style={{ gap: "var(--space-2)" }}>
            <TriangleAlert size={14} className="warn" />
            {warnings} to look at
          </span>
        )}
        {fixable > 0 && <span className="faint">{fixable} with a remedy</span>}
        <span className="grow" />
        {list.length > 0 && (props.open ? <ChevronDown size={14} /> : <ChevronUp size={14} />)}
      </button>
      {props.open && list.length > 0 && (
        <ul className="findings-list">
          {list.slice(0, shownAtOnce).map((f) => (
            <FindingRow
              key={f.id}
              finding={f}
              onFix={props.onFix}
              onJump={props.onJump}
              place={`${f.step ? `${f.step}, ` : ""}line ${props.lineOf(f.from)}`}
            />
          ))}
          {list.length > shownAtOnce && (
            <li className="faint finding-words">and {list.length - shownAtOnce} more</li>
          )}
        </ul>
      )}
    </section>
  );
}
