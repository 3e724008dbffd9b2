// The open document: palette, canvas, properties and text, with one selection and one undo stack over all of them.
import {
  ChevronRight,
  CircleDot,
  CodeXml,
  Columns2,
  Copy,
  Crosshair,
  Download,
  FlaskConical,
  History,
  Link2,
  PanelLeftOpen,
  Play,
  Plus,
  Redo2,
  Rocket,
  Scissors,
  Sparkles,
  TextCursorInput,
  Trash2,
  Undo2,
  WandSparkles,
  Workflow,
} from "lucide-react";
import { useCallback, useEffect, useEffectEvent, useMemo, useRef, useState } from "react";
import { useNames } from "../api/prefixes";
import { useStable } from "../api/stable";
import { kept } from "../api/storage";
import { useCommands, type Command } from "../ui/commands";
import { Guard } from "../ui/guard";
import { Link as AppLink } from "../ui/link";
import { navigate, paths } from "../ui/router";
import { partAt, prefixesOf } from "../cawl/document";
import { shownFlow } from "../cawl/shown";
import { startVariables } from "../cawl/start_values";
import { StartDialog } from "../flow/start_dialog";
import { Dialog } from "../ui/dialog";
import { Picker, type PickerItem } from "../ui/picker";
import { toast } from "../ui/toasts";
import { Actions, type AddWhere, type NewKind } from "./actions";
import { useBreakpoints } from "./breakpoints";
import { Canvas } from "./canvas";
import { unsetFindings, useCalledFlows } from "./called_flows";
import { Crumbs } from "./crumbs";
import { DeployDialog } from "./deploy_dialog";
import { DraftSync } from "./draft_sync";
import { saveFile } from "./files";
import { type Finding, useFindings } from "./findings";
import { FindingsPanel } from "./findings_panel";
import { focusStep } from "./focus_step";
import { ImportDialog } from "./import_dialog";
import { BehindBar, UnkeptBar, useLiveVersion } from "./live_version";
import type { LiveVersion } from "./load_document";
import { keepImported, usePalette } from "../flow/palette_data";
import { PalettePanel } from "./palette_panel";
import { Properties } from "./properties";
import { FirstSteps, QuickAdd, where } from "./quick_add";
import { ServerDraftBar, ServerDraftButton, useServerDraft } from "./server_draft";
import { dropServerDraft, keepSeen } from "./server_drafts";
import { Session } from "./session";
import { TextPane } from "./text_pane";
import { textSetup } from "./text_setup";
import { usePanels } from "./panels";
import { SimulatePanel } from "./simulate_panel";
import { stepTrials, type StepTrial, useTrials } from "./trials";
import { TrialsPanel } from "./trials_panel";
import { readVia, viaText } from "./via";
import { useVocabulary } from "../facts/vocabulary";
import "./editor.css";

type Open =
  | { what: "import" }
  | { what: "add"; where: AddWhere }
  | { what: "connect"; from: string }
  | { what: "deploy" }
  | { what: "start" }
  | null;
let memory = ""; // what was copied last, where the browser's clipboard is closed

interface EditorProps {
  name: string;
  text: string;
  live: LiveVersion | null; // that the server runs
  base: string | null; // the deployed text that `text` began from
  flow: string;
  step: string;
  via: string;
  trial: string;
}

export function Editor(props: EditorProps) {
  const opened = useSession(props.name, props);
  return opened ? (
    <Guard>
      <Open key={props.name} {...props} {...opened} />
    </Guard>
  ) : null; // a view that stops keeps the session, and its undo with it
}

// The session lives as long as the document is open, and the keeping of its draft with it.
function useSession(
  name: string,
  begun: Pick<EditorProps, "text" | "live" | "base">,
): { session: Session; sync: DraftSync } | null {
  const [opened, setOpened] = useState<{ session: Session; sync: DraftSync } | null>(null);
  const first = useRef(begun);
  useEffect(() => {
    const session = new Session(first.current.text, textSetup);
    const sync = new DraftSync(name, session, first.current.live, first.current.base);
    setOpened({ session, sync });
    return () => {
      sync.close();
      first.current = { text: session.written, live: sync.live, base: sync.base };
      session.destroy();
    };
  }, [name]);
  return opened;
}

function Open(props: EditorProps & { session: Session; sync: DraftSync }) {
  const { session, sync, name } = props;
  session.versions.use();
  const document = session.shown;
  const { live, deployed } = useLiveVersion(document.name || name, sync); // a text that was renamed takes the place of what has its new name
  const { good } = session;
  const shown = useMemo(() => shownFlow(document, good, props.flow), [document, good, props.flow]);
  const flowKey = shown?.flow.key ?? "";
  const [steps, setSteps] = useState<ReadonlySet<string>>(() => new Set(props.step ? [props.step] : []));
  const [links, setLinks] = useState<ReadonlySet<string>>(() => new Set());
  const [open, setOpen] = useState<Open>(null);
  const [findingsOpen, setFindingsOpen] = useState(false);
  const conflict = sync.conflicts.use();
  const serverDraft = useServerDraft(name, session, sync);
  const panels = usePanels();
  const palette = usePalette();
  const checked = useFindings(session);
  const names = useNames();
  const trials = useTrials(document.name, session.shown.text, checked);
  const [panel, setPanel] = useState<"trials" | "simulate" | "">(props.trial === "" ? "" : "trials"); // that is open below the canvas
  const toggle = (which: "trials" | "simulate") => setPanel(panel === which ? "" : which);
  const [tried, setTried] = useState(props.trial); // the run whose trial the canvas shows
  const wanted = useRef(props.trial); // of the address: tried once, when it is in the list
  const ready = wanted.current !== "" && trials.list.some((t) => t.run === wanted.current);
  const attemptWanted = useEffectEvent(() => {
    void trials.attempt(wanted.current);
    wanted.current = "";
  });
  useEffect(() => {
    if (ready) attemptWanted();
  }, [ready]);
  const reply = trials.list.find((t) => t.run === tried)?.reply ?? null;
  const trial = useMemo(() => (reply && panel === "trials" ? stepTrials(reply) : null), [reply, panel]);
  const [simulated, setSimulated] = useState<ReadonlyMap<string, StepTrial> | null>(null); // steps at the moment of the simulation that is shown
  const breakpoints = useBreakpoints(name, shown?.flow.name ?? "");
  const prefixes = useStable(prefixesOf(document));
  const vocabulary = useVocabulary(prefixes);
  const called = useCalledFlows(document, palette.entries);
  const unset = useMemo(
    () => unsetFindings(document, called, palette.entries, vocabulary),
    [document, called, palette.entries, vocabulary],
  );
  const findings = useMemo(
    () => (unset.length > 0 ? { ...checked, list: [...checked.list, ...unset] } : checked),
    [checked, unset],
  );
  const serviceNames = useStable(
    new Set(palette.entries.filter((e) => e.kind === "service").map((e) => e.id)),
  );

  const revealStep = useEffectEvent(() => {
    const step = session.document.flows.flatMap((f) => f.steps).find((s) => s.key === props.step);
    if (step) session.reveal(step.element.from, step.element.openTo);
  });
  useEffect(() => revealStep(), [session]); // the step of the address, once
  useEffect(() => {
    const { from, to } = session.view.state.selection.main;
    if (panels.text) session.reveal(from, to);
  }, [session, panels.text]); // a text that was hidden has no place yet
  const selectStep = useEffectEvent(() => {
    setSteps(new Set(props.step ? [props.step] : []));
    setLinks(new Set());
  });
  useEffect(() => selectStep(), [props.flow]); // another flow of the document
  useEffect(() => {
    window.document.title = `${document.name || name} – Docent`;
  }, [document.name, name]);

  const onSelect = useCallback(
    (stepKeys: string[], linkKeys: string[], focus = false) => {
      setSteps(new Set(stepKeys));
      setLinks(new Set(linkKeys));
      const only = stepKeys.length === 1 && linkKeys.length === 0 ? (stepKeys[0] ?? "") : "";
      navigate(paths.compose(name, props.flow, only, props.via), true);
      const part = shownFlow(session.document, session.good, props.flow);
      const element = only
        ? part?.steps.find((s) => s.key === only && !s.stale)?.element
        : linkKeys.length === 1 && stepKeys.length === 0
          ? part?.links.find((l) => l.key === linkKeys[0])?.element
          : undefined;
      if (element && !session.view.hasFocus) session.reveal(element.from, element.openTo);
      if (focus && only) focusStep(only);
    },
    [name, props.flow, props.via, session],
  );
  const actions = useMemo(
    () =>
      new Actions(
        session,
        flowKey,
        (keys) => onSelect(keys, [], true),
        (key) => onSelect([], [key]),
        palette.entries,
      ),
    [session, flowKey, onSelect, palette.entries],
  );
  // What undo or the text has taken away is no longer selected, and is not again when it comes back.
  useEffect(() => {
    const [stepKeys, linkKeys] = [
      new Set(shown?.steps.map((s) => s.key)),
      new Set(shown?.links.map((l) => l.key)),
    ];
    if ([...steps].some((key) => !stepKeys.has(key)))
      setSteps(new Set([...steps].filter((key) => stepKeys.has(key))));
    if ([...links].some((key) => !linkKeys.has(key)))
      setLinks(new Set([...links].filter((key) => linkKeys.has(key))));
  }, [shown, steps, links]);

  const variables = startVariables(document, shown?.flow);
  const chosenSteps = shown?.steps.filter((s) => steps.has(s.key) && !s.stale) ?? [];
  const chosenLinks = shown?.links.filter((l) => links.has(l.key) && !l.stale) ?? [];
  const only = chosenSteps.length === 1 && chosenLinks.length === 0 ? chosenSteps[0] : undefined;

  const quickAdd = useCallback((where: AddWhere) => setOpen({ what: "add", where }), []);
  const addFrom = (what: NewKind) =>
    actions.add(
      what,
      chosenLinks[0] && !only
        ? { link: chosenLinks[0].key }
        : only && only.kind !== "sink"
          ? { after: only.key }
          : where(shown),
    );
  const onFix = useCallback(
    (finding: Finding) => {
      if (session.text !== (finding.of ?? findingsText.current))
        return toast("bad", "The text has changed since", "The check runs again; then the remedy fits.");
      session.change(finding.fix);
      toast("good", "Mended", finding.remedy ?? finding.message);
    },
    [session],
  );
  const findingsText = useRef("");
  findingsText.current = findings.of;
  const onJump = (finding: Finding) => {
    if (finding.flow && finding.flow !== flowKey)
      navigate(paths.compose(name, finding.flow, finding.step, props.via));
    onSelect(finding.step ? [finding.step] : [], finding.link ? [finding.link] : []);
    panels.show("text");
    window.setTimeout(() => session.reveal(finding.from, finding.to));
  };
  const copy = (keys = [...steps]) => {
    const text = actions.copied(keys);
    if (!text) return toast("bad", "Nothing to copy", "Select steps first.");
    memory = text;
    void navigator.clipboard?.writeText(text).catch(() => undefined);
    toast("good", keys.length === 1 ? "The step is copied" : `${keys.length} steps are copied`);
  };
  const paste = async () =>
    actions.paste((await navigator.clipboard?.readText().catch(() => memory)) || memory);
  const connect = () =>
    only && only.kind !== "sink"
      ? setOpen({ what: "connect", from: only.key })
      : toast("bad", "Select one step first", "Then C connects it to another one, by name.");
  // A step that runs a flow is opened in place: a flow of this document, or another workflow.
  const openStep = (key: string) => {
    const target = shown?.steps.find((s) => s.key === key)?.invokes.find((i) => i.kind === "subflow")?.target;
    if (!target) return rename();
    const via = viaText([...readVia(props.via), { name, flow: flowKey, step: key }]);
    navigate(
      document.flows.some((f) => f.key === target)
        ? paths.compose(name, target, "", via)
        : paths.compose(target.split("/")[0] ?? target, target.split("/")[1] ?? "", "", via),
    );
  };
  const rename = () =>
    window.document.querySelector<HTMLInputElement>('.properties-head input[aria-label="Name"]')?.select();

  useCommands([
    {
      title: "Add a step",
      group: "Steps",
      icon: Plus,
      keys: "/",
      words: "insert new",
      run: () =>
        quickAdd(
          chosenLinks[0] && !only ? { link: chosenLinks[0].key } : only ? { after: only.key } : where(shown),
        ),
    },
    { title: "Connect to…", group: "Steps", icon: Link2, keys: "C", words: "link", run: connect },
    ...(only?.invokes.some((i) => i.kind === "subflow")
      ? [
          {
            title: `Open the flow of ${only.name}`,
            group: "Steps",
            icon: Workflow,
            keys: "O",
            words: "module in place",
            run: () => openStep(only.key),
          } satisfies Command,
        ]
      : []),
    { title: "Rename", group: "Steps", icon: TextCursorInput, keys: "F2", run: rename },
    {
      title: "Remove",
      group: "Steps",
      icon: Trash2,
      keys: "Delete|Backspace",
      onCanvas: true,
      words: "delete",
      run: () => actions.remove([...steps], [...links]),
    },
    { title: "Copy", group: "Steps", icon: Copy, keys: "Mod+C", onCanvas: true, run: () => copy() },
    {
      title: "Cut",
      group: "Steps",
      icon: Scissors,
      keys: "Mod+X",
      onCanvas: true,
      run: () => (copy(), actions.remove([...steps], [])),
    },
    { title: "Paste", group: "Steps", keys: "Mod+V", onCanvas: true, run: () => void paste() },
    {
      title: "Duplicate",
      group: "Steps",
      keys: "Mod+D",
      onCanvas: true,
      run: () => actions.paste(actions.copied([...steps])),
    },
    {
      title: "Select all",
      group: "Steps",
      keys: "Mod+A",
      onCanvas: true,
      run: () => onSelect(shown?.steps.filter((s) => !s.stale).map((s) => s.key) ?? [], []),
    },
    { title: "Select nothing", group: "Steps", keys: "Escape", hidden: true, run: () => onSelect([], []) },
    { title: "Undo", group: "Document", icon: Undo2, keys: "Mod+Z", run: session.undo },
    { title: "Redo", group: "Document", icon: Redo2, keys: "Mod+Shift+Z|Mod+Y", run: session.redo },
    {
      title: "Tidy up",
      group: "Document",
      icon: Sparkles,
      keys: "Shift+T",
      words: "layout arrange",
      run: () => actions.tidy(),
    },
    {
      title: "Deploy",
      group: "Document",
      icon: Rocket,
      keys: "Mod+Enter",
      words: "publish",
      run: () => setOpen({ what: "deploy" }),
    },
    { title: "Start a run", group: "Document", icon: Play, keys: "R", run: () => setOpen({ what: "start" }) },
    {
      title: "Try on past runs",
      group: "Document",
      icon: History,
      keys: "Shift+R",
      words: "replay test",
      run: () => toggle("trials"),
    },
    {
      title: "Simulate",
      group: "Document",
      icon: FlaskConical,
      keys: "Shift+S",
      words: "play try robots simulation",
      run: () => toggle("simulate"),
    },
    ...(only?.kind === "node"
      ? [
          {
            title: `${breakpoints.steps.has(only.name) ? "Remove the breakpoint at" : "Set a breakpoint at"} ${only.name}`,
            group: "Steps",
            icon: CircleDot,
            keys: "B",
            words: "simulate stop debug",
            run: () => breakpoints.toggle(only.name),
          } satisfies Command,
        ]
      : []),
    {
      title: "Import steps",
      group: "Document",
      words: "wsdl grpc adapter",
      run: () => setOpen({ what: "import" }),
    },
    {
      title: "Save a copy as a file",
      group: "Document",
      icon: Download,
      keys: "Mod+S",
      inFields: true,
      run: () => saveFile(`${document.name || name}.cawl.xml`, session.written),
    },
    {
      title: "Show or hide the text",
      group: "Document",
      icon: CodeXml,
      keys: "T",
      run: () => panels.toggle("text"),
    },
    {
      title: "Show or hide the palette",
      group: "Document",
      icon: PanelLeftOpen,
      keys: "P",
      run: () => panels.toggle("palette"),
    },
    ...(findings.list[0]
      ? [
          {
            title: "Go to the first finding",
            group: "Document",
            icon: Crosshair,
            keys: "E",
            run: () => findings.list[0] && onJump(findings.list[0]),
          } satisfies Command,
        ]
      : []),
    ...findings.list
      .filter((f) => f.fix.length > 0)
      .slice(0, 100)
      .map((f): Command => ({
        title: `Mend: ${f.message}`,
        group: "Findings",
        icon: WandSparkles,
        run: () => onFix(f),
      })),
    ...(shown?.steps ?? []).map((s): Command => ({
      title: `Go to step ${s.name}`,
      group: "Go to",
      words: "node",
      run: () => onSelect([s.key], [], true),
    })),
  ]);

  const dirty = session.written !== live?.text;
  return (
    <main
      className={`editor tab-${panels.tab}${panels.palette ? " with-palette" : ""}${panels.text ? " with-text" : ""}`}
    >
      <header className="head">
        <AppLink href={paths.documents()} className="faint crumb">
          Workflows
        </AppLink>
        <ChevronRight size={13} className="faint crumb" />
        <Crumbs via={props.via} />
        <h1 className="cut">{document.name || name}</h1>
        {dirty ? (
          <span
            className="tag accent"
            title={sync.isKept ? "Kept in this browser" : "Not kept in this browser"}
          >
            draft
          </span>
        ) : (
          <span className="tag good">deployed</span>
        )}
        {document.flows.length > 1 && (
          <nav className="segments flows" aria-label="Flows">
            {document.flows.map((f) => (
              <button
                key={f.key}
                aria-pressed={f.key === flowKey}
                onClick={() => navigate(paths.compose(name, f.key, "", props.via))}
              >
                {f.name}
              </button>
            ))}
          </nav>
        )}
        <span className="grow" />
        <button
          className="button plain icon"
          aria-label="Undo"
          title="Undo (Ctrl-Z)"
          disabled={!session.canUndo}
          onClick={session.undo}
        >
          <Undo2 size={15} />
        </button>
        <button
          className="button plain icon"
          aria-label="Redo"
          title="Redo (Ctrl-Shift-Z)"
          disabled={!session.canRedo}
          onClick={session.redo}
        >
          <Redo2 size={15} />
        </button>
        <ServerDraftButton draft={serverDraft} dirty={dirty} />
        <button
          className="button plain wide-only"
          title="Arrange the steps (Shift-T)"
          onClick={() => actions.tidy()}
        >
          <Sparkles size={14} />
          Tidy
        </button>
        <button
          className="button plain wide-only"
          aria-pressed={panels.text}
          title="Show or hide the text (T)"
          onClick={() => panels.toggle("text")}
        >
          <Columns2 size={15} />
          Text
        </button>
        {live ? (
          <button
            className="button"
            title="Start a run by hand (R)"
            aria-label="Run"
            onClick={() => setOpen({ what: "start" })}
          >
            <Play size={13} />
            <span className="wide-only">Run</span>
          </button>
        ) : null}
        <button className="button primary" onClick={() => setOpen({ what: "deploy" })}>
          <Rocket size={14} />
          Deploy
        </button>
      </header>
      <UnkeptBar sync={sync} full={kept.open()} />
      <BehindBar sync={sync} />
      <ServerDraftBar draft={serverDraft} session={session} />
      {conflict !== null && (
        <div className="stale" role="alert">
          Another tab has changed the same place of this draft.
          <button className="button small" onClick={() => sync.take()}>
            Take its text
          </button>
          <button className="button small" onClick={() => sync.keep()}>
            Keep mine
          </button>
        </div>
      )}
      <div className="narrow-tabs segments" role="tablist" aria-label="Parts of the view">
        {(["canvas", "properties", "text"] as const).map((tab) => (
          <button key={tab} role="tab" aria-selected={panels.tab === tab} onClick={() => panels.setTab(tab)}>
            {tab[0]?.toUpperCase()}
            {tab.slice(1)}
          </button>
        ))}
      </div>
      <div className="editor-body">
        {panels.palette ? (
          <PalettePanel
            palette={palette}
            name={document.name}
            onAdd={addFrom}
            onImport={() => setOpen({ what: "import" })}
            onHide={() => panels.toggle("palette")}
          />
        ) : (
          <button
            className="palette-open button icon"
            aria-label="Show the palette"
            title="Show the palette (P)"
            onClick={() => panels.toggle("palette")}
          >
            <PanelLeftOpen size={15} />
          </button>
        )}
        <div className="stage">
          {shown ? (
            <Canvas
              shown={shown}
              findings={findings.list}
              serviceNames={serviceNames}
              selected={steps}
              selectedLinks={links}
              refreshed={session.refreshed}
              trial={trial ?? simulated}
              breakpoints={breakpoints.steps}
              onBreakpoint={breakpoints.toggle}
              actions={actions}
              onSelect={onSelect}
              onQuickAdd={quickAdd}
              onOpen={openStep}
            >
              {shown.steps.filter((s) => s.kind === "node").length === 0 && (
                <FirstSteps onAdd={() => quickAdd(where(shown))} />
              )}
              {document.problems.length > 0 && (
                <div className="broken" role="status">
                  The text has a mistake. You see the last good steps; what is dashed can't be changed until
                  it is mended.
                </div>
              )}
            </Canvas>
          ) : (
            <div className="nothing grow">
              <h2>There is no flow to show</h2>
              <p>
                The text needs a &lt;CAWL&gt; element with a &lt;flow&gt; in it. Undo brings the last text
                back.
              </p>
            </div>
          )}
          <FindingsPanel
            findings={findings}
            lineOf={(offset) =>
              session.view.state.doc.lineAt(Math.min(offset, session.view.state.doc.length)).number
            }
            open={findingsOpen}
            onToggle={() => setFindingsOpen(!findingsOpen)}
            onFix={onFix}
            onJump={onJump}
          />
          {shown && (
            <SimulatePanel
              workflow={document.name || name}
              text={session.shown.text}
              shown={shown}
              variables={variables}
              findings={findings}
              breakpoints={breakpoints.steps}
              names={names}
              prefixes={prefixes}
              vocabulary={vocabulary}
              open={panel === "simulate"}
              onToggle={() => toggle("simulate")}
              onStates={setSimulated}
            />
          )}
          {document.name && (
            <TrialsPanel
              trials={trials}
              text={session.shown.text}
              names={names}
              open={panel === "trials"}
              chosen={tried}
              onToggle={() => toggle("trials")}
              onChoose={setTried}
              onStep={(step) => shown?.steps.some((s) => s.name === step) && onSelect([step], [], true)}
            />
          )}
        </div>
        <aside className="dock" style={{ width: panels.width }} aria-label="Properties and text">
          <div
            className="dock-grip"
            role="separator"
            aria-orientation="vertical"
            aria-label="Width of the text"
            aria-valuenow={panels.width}
            aria-valuemin={320}
            aria-valuemax={Math.max(320, window.innerWidth - 420)}
            tabIndex={0}
            onPointerDown={panels.grip}
            onKeyDown={panels.gripKeys}
          />
          <div className="dock-properties">
            {shown && document.root && (
              <Properties
                session={session}
                document={document}
                flow={shown.flow}
                steps={chosenSteps}
                links={chosenLinks}
                actions={actions}
                findings={findings.list}
                compiled={findings.conditions}
                palette={palette.entries}
                called={called}
                vocabulary={vocabulary}
                onFix={onFix}
                onJump={onJump}
                onCopy={() => copy()}
                runs={trials.list}
              />
            )}
          </div>
          <TextPane
            session={session}
            findings={findings.list}
            onFix={onFix}
            onCaret={(offset) => {
              const part = partAt(session.shown, offset);
              if (part && part.flow.key === flowKey && (part.step || part.link)) {
                setSteps(new Set(part.step ? [part.step.key] : []));
                setLinks(new Set(part.link ? [part.link.key] : []));
              }
            }}
          />
        </aside>
      </div>
      {open?.what === "add" && (
        <QuickAdd
          palette={palette.entries}
          name={document.name}
          where={open.where}
          actions={actions}
          onClose={() => setOpen(null)}
        />
      )}
      {open?.what === "connect" && shown && (
        <Dialog label="Connect to" top onClose={() => setOpen(null)}>
          <Picker
            label="Connect to"
            placeholder={`Connect ${shown.steps.find((s) => s.key === open.from)?.name ?? ""} to…`}
            empty="No step has this name."
            onDone={() => setOpen(null)}
            items={shown.steps
              .filter(
                (s) =>
                  s.key !== open.from &&
                  s.kind !== "source" &&
                  !s.stale &&
                  !shown.links.some(
                    (l) =>
                      l.kind === "plain" &&
                      l.from === shown.steps.find((x) => x.key === open.from)?.name &&
                      l.to === s.name,
                  ),
              )
              .map((s): PickerItem => ({
                id: s.key,
                title: s.name,
                detail: s.kind === "sink" ? "end of the flow" : s.invokes.map((i) => i.target).join(", "),
                icon: <Link2 size={15} />,
                run: () => actions.connect(open.from, s.key),
              }))}
          />
        </Dialog>
      )}
      {open?.what === "import" && (
        <ImportDialog
          onImported={(entries) => (
            keepImported(entries),
            palette.again(),
            toast("good", `${entries.length} steps are in the palette`)
          )}
          onClose={() => setOpen(null)}
        />
      )}
      {open?.what === "deploy" && (
        <DeployDialog
          session={session}
          document={document}
          findings={findings}
          sync={sync}
          onDeployed={(text, version) => (
            deployed(text, version),
            keepSeen(name, ""),
            void dropServerDraft(name).catch(() => undefined)
          )}
          onClose={() => setOpen(null)}
        />
      )}
      {open?.what === "start" && (
        <StartDialog
          workflow={document.name}
          variables={variables}
          flow={shown?.flow.name ?? ""}
          vocabulary={vocabulary}
          prefixes={prefixes}
          onClose={() => setOpen(null)}
        />
      )}
    </main>
  );
}
