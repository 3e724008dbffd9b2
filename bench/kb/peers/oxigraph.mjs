// NPM=FOLDER node oxigraph.mjs JOB.json: Oxigraph's npm build (WASM) as a measured system of `docent-bench kb`.
// FOLDER holds node_modules/oxigraph. What it prints: bench/kb/kb_docent_main.cc.
import { createRequire } from 'node:module';
import { readFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { createInterface } from 'node:readline';

const job_file = process.argv[2];
const oxigraph = createRequire(resolve(process.env.NPM, 'peer.js'))('oxigraph');
const job = JSON.parse(readFileSync(job_file, 'utf8'));
const print = (line) => console.log(JSON.stringify(line));
const seconds = (since) => Number(process.hrtime.bigint() - since) / 1e9;

const before = process.memoryUsage().rss;
const store = new oxigraph.Store();
let start = process.hrtime.bigint();
store.load(readFileSync(job.data, 'utf8'), { format: 'application/n-triples', no_transaction: true });
print({ load_s: seconds(start), bytes: process.memoryUsage().rss - before });

function run(text, form) {
  const answer = store.query(text);
  if (form === 'ask') return answer ? 1 : 0;
  let sink = 0;
  for (const row of answer) for (const term of row.values()) sink += term.value.length;
  if (form !== 'count') return answer.length;
  return Number(answer[0].get('count').value);
}

function measure(c, number) {
  const texts = c.parameters.map((p) => c.text.replaceAll('@P@', p));
  const answers = [], passes = [];
  const budget = job.budget_ms / 1000;
  try {
    run(texts[0], c.form);
    const begun = process.hrtime.bigint();
    for (let pass = 0; pass < job.passes && (pass === 0 || seconds(begun) < budget); ++pass) {
      const us = [];
      for (let i = 0; i < texts.length && (i === 0 || seconds(begun) < budget); ++i) {
        start = process.hrtime.bigint();
        const answer = run(texts[i], c.form);
        us.push(seconds(start) * 1e6);
        if (pass === 0) answers.push(answer);
      }
      if (pass === 0 || us.length === passes[0].length) passes.push(us);
    }
    print({ case: number, mode: 'cold', answers, us: passes });
  } catch (error) {
    print({ case: number, mode: 'cold', reason: String(error) });
  }
}

for await (const request of createInterface({ input: process.stdin })) {
  const number = Number(request.split(' ')[0]);
  measure(job.cases[number], number);
}
