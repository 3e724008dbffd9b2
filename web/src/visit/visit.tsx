// The page of visitors' phones: where they are, what they would like, and then how far it is.
import { Languages, MapPin, Unplug } from "lucide-react";
import { useEffect, useEffectEvent, useMemo, useState } from "react";
import { useConnection, serverAnswered, serverSilent } from "../api/connection";
import { live } from "../api/live";
import { clockMinutes } from "../api/times";
import { kept } from "../api/storage";
import { choose, useChoice } from "./address";
import { Choosing } from "./choosing";
import { useKept } from "./kept";
import { readOffers } from "./offers";
import { findPlace, placeWords, readPlaces } from "./places";
import { Progress } from "./progress";
import { arrive, useVisitor } from "./visitor";
import { chooseLanguage, LanguageContext, languages, sayIn, useWords } from "./words";
import "./visit.css";

const languageKey = "docent.visit.language";

export function Visit() {
  const [language, setLanguage] = useState(() =>
    chooseLanguage([
      new URLSearchParams(location.search).get("lang") ?? "",
      readLanguage(),
      ...navigator.languages,
    ]),
  );
  const words = useMemo(() => ({ language, say: sayIn(language) }), [language]);
  useEffect(() => {
    document.documentElement.lang = language;
    document.title = words.say("heading");
  }, [language, words]);
  return (
    <LanguageContext value={words}>
      <header className="visit-head">
        <img src="/icon.svg" alt="" width={28} height={28} />
        <b>Docent</b>
        <label className="visit-language">
          <Languages size={17} aria-hidden />
          <span className="unseen">{words.say("language.choose")}</span>
          <select
            value={language}
            onChange={(e) => (keepLanguage(e.target.value), setLanguage(e.target.value))}
          >
            {[...languages].map(([tag, texts]) => (
              <option key={tag} value={tag}>
                {texts.language}
              </option>
            ))}
          </select>
        </label>
      </header>
      <Away />
      <Body />
    </LanguageContext>
  );
}

function Body() {
  const { language, say } = useWords();
  const visitor = useVisitor();
  const choice = useChoice();
  const places = useKept(`places.${language}`, (signal) => readPlaces(language, signal), 60_000);
  const offers = useKept(`offers.${language}`, (signal) => readOffers(language, signal), 10_000);
  const scanned = places.data ? findPlace(places.data.list, choice.at) : undefined;
  const scannedIri = scanned?.iri ?? "";
  const arriveAt = useEffectEvent((iri: string) => {
    if (iri !== visitor.at) arrive(iri);
  });
  // A code that is scanned says where the visitor is now, also while the robot is on its way.
  useEffect(() => {
    if (scannedIri) arriveAt(scannedIri);
  }, [scannedIri]);
  const at = places.data?.list.find((p) => p.iri === visitor.at);
  return (
    <main className="visit">
      <h1 className={visitor.asked ? "unseen" : ""}>{say("heading")}</h1>
      {at && choice.step !== "at" && (
        <p className="visit-at">
          <MapPin size={17} aria-hidden />
          <span className="grow">{say("where.now", { place: placeWords(at) })}</span>
          <button className="visit-link" onClick={() => choose({ step: "at" })}>
            {say("where.change")}
          </button>
        </p>
      )}
      {places.data && choice.at && !scanned && (
        <p className="visit-notice" role="alert">
          {say("where.unknown", { place: choice.at })}
        </p>
      )}
      {!places.data ? (
        <p className="visit-loading" role="status">
          {say("loading")}
        </p>
      ) : visitor.asked && choice.step !== "at" ? (
        <Progress places={places.data} offers={offers.data ?? []} />
      ) : (
        <Choosing places={places.data} offers={offers.data} />
      )}
      <p className="visit-privacy">{say("privacy")}</p>
    </main>
  );
}

// Says since when there is no connection, and looks for it as long as the live connection does not.
function Away() {
  const { say } = useWords();
  const connection = useConnection();
  useEffect(() => {
    let ended = false;
    let timer = 0;
    const look = async () => {
      if (live.state !== "open" && !document.hidden)
        await fetch("/healthz", { cache: "no-store", signal: AbortSignal.timeout(6000) }).then(
          (r) => (r.ok ? serverAnswered() : serverSilent()),
          serverSilent,
        );
      if (!ended) timer = window.setTimeout(() => void look(), 3000);
    };
    const off = () => serverSilent();
    window.addEventListener("offline", off);
    void look();
    return () => {
      ended = true;
      window.clearTimeout(timer);
      window.removeEventListener("offline", off);
    };
  }, []);
  if (connection.state !== "away") return null;
  return (
    <p className="visit-away" role="status">
      <Unplug size={16} aria-hidden />
      {say("away", { time: clockMinutes(BigInt(connection.since) * 1000n) })}
    </p>
  );
}

function readLanguage(): string {
  return kept.getItem(languageKey) ?? "";
}
function keepLanguage(language: string) {
  kept.setItem(languageKey, language);
}
