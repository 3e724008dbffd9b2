// The answer of a query that is followed: changes put together to the rows of now.
import type { Row as RowMessage } from "./gen/docent/v1/context_pb.js";
import type { SubscribeReply } from "./gen/docent/v1/context_pb.js";
import { type Row, termKey, valueOf } from "./terms.js";

export class WatchedAnswer {
  private variables: readonly string[] = [];
  private readonly rows = new Map<string, { row: Row; count: number }>();

  // The whole answer; undefined: further parts of the change have yet to come. An ASK that is true is one row without variables.
  apply(reply: SubscribeReply): Row[] | undefined {
    if (reply.reset) {
      this.variables = reply.variables;
      this.rows.clear();
    }
    if (reply.isBoolean) return reply.boolean ? [{}] : [];
    for (const { row, count } of reply.disappeared) this.add(row, -Number(count));
    for (const { row, count } of reply.appeared) this.add(row, Number(count));
    if (reply.more) return undefined;
    return [...this.rows.values()].flatMap(({ row, count }) => Array.from({ length: count }, () => row));
  }

  private add(message: RowMessage | undefined, count: number) {
    const values = message?.values ?? [];
    const key = values.map(termKey).join(" ");
    const known = this.rows.get(key) ?? {
      row: Object.fromEntries(this.variables.map((name, i) => [name, valueOf(values[i])])),
      count: 0,
    };
    if (known.count + count === 0) this.rows.delete(key);
    else this.rows.set(key, { row: known.row, count: known.count + count });
  }
}
