// What a visitor chooses before a robot is called: the place, the service, the booth where the service needs one.
import { Bot, ChevronRight, Sparkles } from "lucide-react";
import { choose, useChoice } from "./address";
import type { Offer } from "./offers";
import { PlacePicker } from "./place_picker";
import { type Place, type Places, placeWords } from "./places";
import { arrive, call, useVisitor } from "./visitor";
import { useWords } from "./words";

export function Choosing({ places, offers }: { places: Places; offers: Offer[] | undefined }) {
  const { say } = useWords();
  const choice = useChoice();
  const visitor = useVisitor();
  const at = places.list.find((p) => p.iri === visitor.at);
  const offer = offers?.find((o) => o.iri === choice.service && o.live);
  const booth = places.list.find((p) => p.iri === choice.booth && p.booth);
  if (choice.step === "at" || !at)
    return (
      <PlacePicker
        title={say("where.title")}
        hint={say("where.hint")}
        places={places}
        list={places.list}
        picked={visitor.at}
        onPick={(place) => (arrive(place.iri), choose({ step: "", at: "" }))}
      />
    );
  if (!offer || choice.step === "service")
    return <ServicePicker offers={offers} onPick={(one) => choose({ service: one.iri, step: "" })} />;
  if (offer.asksBooth && (!booth || choice.step === "booth"))
    return (
      <PlacePicker
        title={say("booth.title")}
        places={places}
        list={places.list.filter((p) => p.booth)}
        picked={choice.booth}
        onPick={(place) => choose({ booth: place.iri, step: "" })}
      />
    );
  return <Summary offer={offer} booth={offer.asksBooth ? booth : undefined} />;
}

function ServicePicker({ offers, onPick }: { offers: Offer[] | undefined; onPick: (offer: Offer) => void }) {
  const { say } = useWords();
  return (
    <section aria-labelledby="service-title">
      <h2 id="service-title">{say("service.title")}</h2>
      {!offers && (
        <p className="visit-loading" role="status">
          {say("loading")}
        </p>
      )}
      {offers?.length === 0 && <p className="visit-notice">{say("service.none")}</p>}
      <ul className="visit-cards">
        {offers?.map((offer) => (
          <li key={offer.iri}>
            <button className="visit-card" disabled={!offer.live} onClick={() => onPick(offer)}>
              <span className="visit-icon">
                <Sparkles size={20} aria-hidden />
              </span>
              <span className="grow">
                <b>{offer.name}</b>
                {offer.text && <span>{offer.text}</span>}
                {!offer.live && <span className="visit-off">{say("service.off")}</span>}
              </span>
              <ChevronRight size={18} aria-hidden />
            </button>
          </li>
        ))}
      </ul>
    </section>
  );
}

function Summary({ offer, booth }: { offer: Offer; booth: Place | undefined }) {
  const { say } = useWords();
  return (
    <section className="visit-summary">
      <div className="visit-chosen">
        <span className="visit-icon">
          <Sparkles size={20} aria-hidden />
        </span>
        <span className="grow">
          <b>{offer.name}</b>
          <span>{offer.text}</span>
        </span>
        <button className="visit-link" onClick={() => choose({ step: "service" })}>
          {say("service.change")}
        </button>
      </div>
      {booth && (
        <div className="visit-chosen">
          <span className="visit-icon booth">{booth.name}</span>
          <span className="grow">
            <b>{placeWords(booth)}</b>
          </span>
          <button className="visit-link" onClick={() => choose({ step: "booth" })}>
            {say("booth.change")}
          </button>
        </div>
      )}
      <button
        className="visit-main"
        onClick={() => (
          call(offer.iri, booth?.iri ?? ""),
          choose({ service: "", booth: "", step: "", at: "" }, true)
        )}
      >
        <Bot size={20} aria-hidden />
        {say("call")}
      </button>
    </section>
  );
}
