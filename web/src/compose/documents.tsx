// All workflows: the deployed ones, the drafts of this browser, and ways to begin.
import {
  CircleDot,
  Cloud,
  FileUp,
  PauseCircle,
  Pencil,
  Plus,
  PowerOff,
  Trash2,
  Unplug,
  Workflow,
} from "lucide-react";
import { useEffect, useState } from "react";
import { workflows } from "../api/client";
import { usePoll } from "../api/poll";
import { kept as storage } from "../api/storage";
import { clockMinutes, timeTitle } from "../api/times";
import { useCommands } from "../ui/commands";
import { Link } from "../ui/link";
import { navigate, paths } from "../ui/router";
import { readCawl } from "../cawl/document";
import { uniqueName } from "../cawl/names";
import { type Template, templates } from "../cawl/templates";
import { Dialog } from "../ui/dialog";
import { toast } from "../ui/toasts";
import { dropDraft, listDrafts, loadDraft, saveDraft } from "../flow/drafts";
import { listServerDrafts } from "./server_drafts";
import { openFile } from "./files";
import { TemplateCards } from "./template_cards";
import "./documents.css";

const usOf = (time: string) => BigInt(Date.parse(time) || 0) * 1000n;

export default function Documents() {
  useEffect(() => void (document.title = "Workflows – Docent"), []);
  const polled = usePoll("workflows", (signal) => workflows.list({}, { signal }), 3000);
  const onServer = usePoll("server drafts", listServerDrafts, 5000);
  const [drafts, setDrafts] = useState(listDrafts);
  const [template, setTemplate] = useState<Template | null>(null);
  const deployed = polled.data?.workflows ?? [];
  const kept = onServer.data ?? [];
  const taken = new Set([
    ...deployed.map((w) => w.name),
    ...drafts.map((d) => d.name),
    ...kept.map((d) => d.name),
  ]);
  const open = async () => {
    const file = await openFile();
    if (!file) return;
    const document = readCawl(file.text);
    const name = document.name || file.name.replace(/\.(cawl|xml)/g, "");
    if (loadDraft(name) && loadDraft(name)?.text !== file.text) {
      const fresh = uniqueName(taken, name);
      saveDraft(fresh, file.text, "");
      toast("good", `Opened as ${fresh}`, `There is a draft of ${name} already.`);
      return navigate(paths.compose(fresh));
    }
    saveDraft(name, file.text, "");
    navigate(paths.compose(name));
  };
  useCommands([
    ...templates.map((t) => ({
      title: `New: ${t.title.toLowerCase()}`,
      group: "Workflows",
      icon: Plus,
      words: "create workflow template",
      ...(t.id === "empty" && { keys: "N" }),
      run: () => setTemplate(t),
    })),
    { title: "Open a file", group: "Workflows", icon: FileUp, keys: "O", run: () => void open() },
    ...deployed.map((w) => ({
      title: `Open ${w.name}`,
      group: "Workflows",
      icon: Workflow,
      run: () => navigate(paths.compose(w.name)),
    })),
  ]);
  const rows = [
    ...deployed.map((w) => ({
      name: w.name,
      workflow: w,
      draft: drafts.find((d) => d.name === w.name)?.draft,
    })),
    ...drafts
      .filter((d) => !deployed.some((w) => w.name === d.name))
      .map((d) => ({ name: d.name, workflow: undefined, draft: d.draft })),
    ...kept
      .filter((d) => !deployed.some((w) => w.name === d.name) && !drafts.some((x) => x.name === d.name))
      .map((d) => ({ name: d.name, workflow: undefined, draft: undefined })),
  ];
  return (
    <main className="view">
      <div className="wide">
        <div className="row" style={{ marginBottom: "var(--space-3)" }}>
          <h1 className="grow">Workflows</h1>
          <button className="button" onClick={() => void open()}>
            <FileUp size={14} />
            Open a file
          </button>
          <button className="button primary" onClick={() => setTemplate(templates[0] ?? null)}>
            <Plus size={15} />
            New workflow
          </button>
        </div>
        <p className="quiet" style={{ marginBottom: "var(--space-9)" }}>
          What robots do for people here: steps, and the situations that open them.
        </p>
        {!storage.open() && (
          <div className="notice wait" role="status" style={{ marginBottom: "var(--space-8)" }}>
            <Unplug size={15} />
            <div>
              <b>This browser keeps nothing: drafts are not kept.</b> Its storage is blocked. What you write
              lasts as long as this page; save it as a file or on the server.
            </div>
          </div>
        )}
        {polled.error && !polled.data && (
          <div className="notice wait" style={{ marginBottom: "var(--space-8)" }}>
            <Unplug size={15} />
            <div>
              <b>{polled.error.title}.</b> {polled.error.detail} You can write drafts meanwhile.
            </div>
          </div>
        )}
        {rows.length > 0 && (
          <ul className="documents card">
            {rows.map(({ name, workflow, draft }) => (
              <li key={name}>
                <Link href={paths.compose(name)} className="document">
                  <span className={`document-icon${workflow ? "" : " draft"}`}>
                    {workflow ? <Workflow size={16} /> : <Pencil size={15} />}
                  </span>
                  <span className="document-words">
                    <b className="cut">{name}</b>
                    <span className="faint small cut">
                      {workflow
                        ? [
                            workflow.version && `version ${workflow.version}`,
                            workflow.flows.length > 1 && `${workflow.flows.length} flows`,
                            workflow.activatedFlow ? "starts by itself" : "started by hand",
                          ]
                            .filter(Boolean)
                            .join(" · ")
                        : "never deployed"}
                    </span>
                  </span>
                  {draft && (
                    <span className="tag accent" title={timeTitle(BigInt(draft.savedMs) * 1000n)}>
                      <Pencil size={11} />
                      draft of {clockMinutes(BigInt(draft.savedMs) * 1000n)}
                    </span>
                  )}
                  {kept
                    .filter((d) => d.name === name)
                    .map((d) => (
                      <span
                        key={d.saved}
                        className="tag"
                        title={`Saved on the server, ${timeTitle(usOf(d.saved))}: it can be opened in any browser`}
                      >
                        <Cloud size={11} />
                        on the server, {clockMinutes(usOf(d.saved))}
                      </span>
                    ))}
                  {workflow?.paused && (
                    <span className="tag wait">
                      <PauseCircle size={12} />
                      paused
                    </span>
                  )}
                  {workflow?.disabled && (
                    <span className="tag">
                      <PowerOff size={11} />
                      off
                    </span>
                  )}
                  {workflow && !workflow.paused && !workflow.disabled && (
                    <span className="tag good">
                      <CircleDot size={11} />
                      deployed
                    </span>
                  )}
                </Link>
                {workflow && (
                  <Link className="button plain small" href={paths.runs("", name)}>
                    Runs{workflow.liveRuns > 0 ? ` (${workflow.liveRuns})` : ""}
                  </Link>
                )}
                {draft && (
                  <button
                    className="button plain icon small"
                    title="Throw the draft away"
                    aria-label={`Throw the draft of ${name} away`}
                    onClick={() => {
                      dropDraft(name);
                      setDrafts(listDrafts());
                      toast("good", "The draft is gone", name, {
                        label: "Undo",
                        run: () => (saveDraft(name, draft.text, draft.base), setDrafts(listDrafts())),
                      });
                    }}
                  >
                    <Trash2 size={14} />
                  </button>
                )}
              </li>
            ))}
          </ul>
        )}
        <h2 style={{ margin: rows.length > 0 ? "34px 0 12px" : "8px 0 12px" }}>
          {rows.length > 0 ? "Begin another" : "Begin with a template"}
        </h2>
        <TemplateCards templates={templates} onChoose={setTemplate} />
      </div>
      {template && <NameDialog template={template} taken={taken} onClose={() => setTemplate(null)} />}
    </main>
  );
}

function NameDialog(props: { template: Template; taken: ReadonlySet<string>; onClose: () => void }) {
  const [name, setName] = useState(
    uniqueName(
      props.taken,
      props.template.id === "empty"
        ? "MyService"
        : props.template.title.replace(/\b\w/g, (c) => c.toUpperCase()).replace(/ /g, ""),
    ),
  );
  const wrong =
    name.trim() === ""
      ? "It needs a name."
      : props.taken.has(name.trim())
        ? "There is one of this name already."
        : new TextEncoder().encode(name).length > 256
          ? "The name is too long: at most 256 bytes."
          : "";
  return (
    <Dialog label="New workflow" width={420} top onClose={props.onClose}>
      <form
        onSubmit={(e) => {
          e.preventDefault();
          if (wrong) return;
          saveDraft(name.trim(), props.template.text(name.trim()), "");
          props.onClose();
          navigate(paths.compose(name.trim()));
        }}
      >
        <div className="sheet-head">
          <h2>{props.template.title}</h2>
        </div>
        <div className="sheet-body" style={{ display: "grid", gap: "var(--space-4)" }}>
          <label className="quiet small" htmlFor="new-name">
            Name of the workflow
          </label>
          <input
            id="new-name"
            className="field"
            style={{ height: 36 }}
            autoFocus
            value={name}
            onFocus={(e) => e.target.select()}
            onChange={(e) => setName(e.target.value)}
            aria-describedby="new-wrong"
          />
          <p id="new-wrong" className="small" style={{ color: "var(--bad)", minHeight: 18 }}>
            {wrong}
          </p>
        </div>
        <div className="sheet-foot">
          <button type="button" className="button" onClick={props.onClose}>
            Cancel
          </button>
          <button className="button primary" disabled={wrong !== ""}>
            Create
          </button>
        </div>
      </form>
    </Dialog>
  );
}
