// Before a workflow is deployed: what changes against the one that runs, and what the check says.
import { CircleAlert, Copy, Rocket, X } from "lucide-react";
import { useCallback, useMemo, useState } from "react";
import { workflows } from "../api/client";
import { plain, type PlainError } from "../api/errors";
import { navigate, paths } from "../ui/router";
import { type CawlDocument, readCawl, type Flow, type Step } from "../cawl/document";
import { Dialog } from "../ui/dialog";
import { DeployFlow } from "./deploy_flow";
import { toast } from "../ui/toasts";
import type { DraftSync } from "./draft_sync";
import type { Findings } from "./findings";
import { askLive, BehindChoices, behindWords, liveNumber } from "./live_version";
import type { Session } from "./session";
import { StartsNow } from "./starts_now";
import { diffLines, proposedVersion } from "./text_diff";
import "./deploy.css";

export function DeployDialog(props: {
  session: Session;
  document: CawlDocument;
  findings: Findings;
  sync: DraftSync;
  onDeployed: (text: string, version: string) => void;
  onClose: () => void;
}) {
  const { session, document, findings, sync } = props;
  sync.turns.use();
  const deployed = sync.live?.text ?? null;
  const [takesBack, setTakesBack] = useState<string | null>(null); // the text of a live version that may be taken back
  const behind = sync.behind;
  const asks = behind && takesBack !== deployed;
  const [busy, setBusy] = useState(false);
  const [error, setError] = useState<PlainError | null>(null);
  const errors = findings.list.filter((f) => f.error);
  const shared = findings.list.filter((f) => f.rule === "shared-start"); // another workflow starts on the same occasion
  const warnings = findings.list.filter((f) => !f.error && !shared.includes(f));
  const diff = useMemo(
    () => (deployed === null ? [] : diffLines(deployed, document.text)),
    [deployed, document.text],
  );
  const old = useMemo(() => (deployed === null ? null : readCawl(deployed)), [deployed]);
  const [typed, setTyped] = useState<string | null>(null);
  const version =
    typed ??
    (old && sync.live && deployed !== document.text
      ? proposedVersion(document.version, old.version)
      : document.version); // is written into the text with the deployment
  const drawn = old
    ? document.flows
        .filter(
          (flow) =>
            flowText(document, flow) !==
            flowText(
              old,
              old.flows.find((f) => f.name === flow.name),
            ),
        )
        .slice(0, 3)
    : [];
  const textOf = useCallback(
    (side: "before" | "after", step: Step) => stepText(side === "before" && old ? old : document, step),
    [old, document],
  );
  const steps = useMemo(() => (old === null ? null : stepDiff(old, document)), [old, document]);
  const deploy = async () => {
    setBusy(true);
    setError(null);
    try {
      // Somebody may have deployed another version since the last look; or does so now, and then the server refuses ours.
      const replaces = await liveNumber(document.name);
      const now = await askLive(document.name, sync.live).catch(() => null);
      if (now) sync.sees(now);
      if (sync.behind && takesBack !== sync.live?.text) return setBusy(false);
      if (version.trim() !== document.version)
        session.edit(
          document.flows[0]?.key ?? "",
          (e) => document.root && e.set(document.root, "version", version.trim() || null),
        );
      const text = session.written;
      const reply = await workflows.deploy({
        name: `${document.name}.cawl.xml`,
        cawl: text,
        ...(replaces === undefined ? {} : { replaces }),
      });
      toast(
        "good",
        `${reply.workflow} is deployed`,
        `From now on it runs as you see it here (revision ${reply.revision}).`,
        { label: "Its runs", run: () => navigate(paths.runs("", reply.workflow)) },
      );
      props.onDeployed(text, version.trim());
      props.onClose();
    } catch (failure) {
      setError(plain(failure));
      setBusy(false);
    }
  };
  return (
    <Dialog label="Deploy" width={660} onClose={props.onClose}>
      <div className="sheet-head">
        <h2 className="grow">Deploy {document.name}</h2>
        <button className="button plain icon small" aria-label="Close" onClick={props.onClose}>
          <X size={15} />
        </button>
      </div>
      <div className="sheet-body deploy">
        <p className="quiet">
          {deployed === null
            ? document.activator
              ? "From now on it starts by itself when its situation is true. It can be started by hand, too."
              : "From now on it can be started by hand, and be a step of other workflows."
            : deployed === document.text
              ? "This is the text that is deployed already."
              : "It takes the place of the deployed version. Live runs go on with the version that they began with."}
        </p>
        {behind && sync.live && (
          <div className="notice wait deploy-behind" role="alert">
            <CircleAlert size={15} />
            <div className="grow">
              <b>{behindWords(sync.live, sync.base)} Deploying takes it back.</b>
              {sync.together() === null &&
                " Both changed the same place, so they can’t be put together by themselves."}{" "}
              The differences below are from that version.
              <div className="row">
                <BehindChoices sync={sync} />
              </div>
              <label className="row">
                <input
                  type="checkbox"
                  checked={!asks}
                  onChange={(e) => setTakesBack(e.target.checked ? deployed : null)}
                />
                Deploy this text in its place
              </label>
            </div>
          </div>
        )}
        <div style={{ maxWidth: 160 }}>
          <label className="property">
            <span>Version</span>
            <input
              className="field"
              aria-label="Version"
              value={version}
              placeholder="1.0"
              onChange={(e) => setTyped(e.target.value)}
            />
          </label>
        </div>
        {document.activator &&
          errors.length === 0 &&
          (!old || conditionText(old) !== conditionText(document)) && (
            <StartsNow activator={document.activator} conditions={findings.conditions} again={old !== null} />
          )}
        {errors.length > 0 && (
          <div className="notice bad">
            <CircleAlert size={15} />
            <div>
              <b>{errors.length} to mend first.</b> {errors[0]?.message}
            </div>
          </div>
        )}
        {errors.length === 0 &&
          shared.map((f) => (
            <div key={f.id} className="notice wait" role="status">
              <Copy size={15} />
              <div>
                <b>{sentenceOf(f.message)}</b> {sentenceOf(f.hint)}
              </div>
            </div>
          ))}
        {errors.length === 0 && warnings.length > 0 && (
          <div className="notice wait">
            <CircleAlert size={15} />
            <div>
              <b>{warnings.length} to look at.</b> {warnings[0]?.message}
            </div>
          </div>
        )}
        {error && (
          <div className="notice bad" role="alert">
            <CircleAlert size={15} />
            <div>
              <b>{error.title}.</b> {error.detail}
            </div>
          </div>
        )}
        {steps && steps.come.length + steps.gone.length + steps.changed.length > 0 && (
          <ul className="deploy-steps">
            {steps.come.map((name) => (
              <li key={`+${name}`} className="new">
                + {name}
              </li>
            ))}
            {steps.changed.map((name) => (
              <li key={`~${name}`} className="changed">
                ~ {name}
              </li>
            ))}
            {steps.gone.map((name) => (
              <li key={`-${name}`} className="gone">
                − {name}
              </li>
            ))}
          </ul>
        )}
        {old &&
          drawn.map((flow) => (
            <DeployFlow
              key={flow.key}
              before={old.flows.find((f) => f.name === flow.name)}
              after={flow}
              textOf={textOf}
            />
          ))}
        {diff.length > 0 && (
          <pre className="deploy-diff" tabIndex={0} aria-label="Differences of the text">
            {diff.map((line, i) => (
              <div key={i} className={line.kind}>
                <span className="number">{line.kind === "gap" ? "⋯" : line.line}</span>
                {line.kind === "new" ? "+" : line.kind === "gone" ? "−" : " "} {line.text}
              </div>
            ))}
          </pre>
        )}
      </div>
      <div className="sheet-foot">
        <button className="button" onClick={props.onClose}>
          Not now
        </button>
        <button
          className="button primary"
          disabled={busy || asks || errors.length > 0}
          title={asks ? "First choose what becomes of the deployed version" : undefined}
          onClick={() => void deploy()}
          data-first
        >
          <Rocket size={14} />
          {busy ? "Deploying" : "Deploy"}
        </button>
      </div>
    </Dialog>
  );
}

const sentenceOf = (text: string) => `${text.charAt(0).toUpperCase()}${text.slice(1)}.`;

// Without the places of steps, which say nothing of what it does.
const placeless = (text: string) => text.replace(/ \w+:[xy]="[^"]*"/g, "");
const stepText = (document: CawlDocument, step: Step) =>
  placeless(document.text.slice(step.element.from, step.element.to));
const conditionText = (document: CawlDocument) =>
  document.activator
    ? placeless(document.text.slice(document.activator.element.from, document.activator.element.to))
    : "";
const flowText = (document: CawlDocument, flow: Flow | undefined) =>
  flow ? placeless(document.text.slice(flow.element.from, flow.element.to)) : "";

function stepDiff(
  before: CawlDocument,
  after: CawlDocument,
): { come: string[]; gone: string[]; changed: string[] } {
  const steps = (document: CawlDocument) =>
    new Map(
      document.flows.flatMap((flow: Flow) =>
        flow.steps.map((s) => [`${flow.name} / ${s.name}`, stepText(document, s)] as const),
      ),
    );
  const [a, b] = [steps(before), steps(after)];
  return {
    come: [...b.keys()].filter((name) => !a.has(name)),
    gone: [...a.keys()].filter((name) => !b.has(name)),
    changed: [...b.keys()].filter((name) => a.has(name) && a.get(name) !== b.get(name)),
  };
}
