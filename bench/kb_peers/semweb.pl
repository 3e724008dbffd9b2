% swipl semweb.pl JOB.json: SWI-Prolog's semweb (library rdf_db) as a measured system of `docent-bench kb`. It has no
% SPARQL: basic graph patterns are run as conjunctions of rdf/3 in the order written, the rest has no figure.
% What it prints: bench/kb_docent_main.cc.
:- use_module(library(semweb/rdf_db)).
:- use_module(library(semweb/rdf_ntriples)).
:- use_module(library(http/json)).
:- use_module(library(time)).
:- use_module(library(aggregate)).
:- use_module(library(readutil)).
:- initialization(main, main).

case_limit_s(4).

main([File]) :-
    setup_call_cleanup(open(File, read, In), json_read_dict(In, Job, [value_string_as_atom(false)]), close(In)),
    resident(Before),
    get_time(T0),
    atom_string(Data, Job.data),
    rdf_load(Data, [format(ntriples), silent(true)]),
    get_time(T1),
    resident(After),
    Load is T1 - T0,
    Bytes is After - Before,
    say(_{load_s: Load, bytes: Bytes}),
    Budget is Job.budget_ms / 1000,
    requests(Job.cases, Job.passes, Budget).

requests(Cases, Passes, Budget) :-
    read_line_to_string(user_input, Line),
    (   Line == end_of_file
    ->  true
    ;   split_string(Line, " ", "", [Text|_]),
        number_string(Number, Text),
        nth0(Number, Cases, Case),
        measure(Number, Case, Passes, Budget),
        requests(Cases, Passes, Budget)
    ).

resident(Bytes) :-
    setup_call_cleanup(open('/proc/self/statm', read, In), read_string(In, _, Text), close(In)),
    split_string(Text, " ", "\n", [_, Pages|_]),
    number_string(N, Pages),
    Bytes is N * 4096.

say(Dict) :- json_write_dict(current_output, Dict, [width(0)]), nl, flush_output.

measure(Number, Case, _, _) :-
    Case.goal == "", !,
    say(_{case: Number, mode: "cold", reason: "no SPARQL: only basic graph patterns of IRIs"}).
measure(Number, Case, Most, Budget) :-
    case_limit_s(Limit),
    catch(( call_with_time_limit(Limit, passes(Case, Most, Budget, Answers, Passes)),
            say(_{case: Number, mode: "cold", answers: Answers, us: Passes}) ),
          Error,
          ( message_to_codes(Error, Text), say(_{case: Number, mode: "cold", reason: Text}) )).

message_to_codes(Error, Text) :- term_to_atom(Error, Text).

passes(Case, Most, Budget, Answers, [Us|Rest]) :-
    [First|_] = Case.parameters,
    run(Case, First, _),
    get_time(Begun),
    pass(Case, Begun, Budget, Answers, Us),
    length(Us, Length),
    More is Most - 1,
    more(More, Case, Begun, Budget, Length, Rest).

more(0, _, _, _, _, []) :- !.
more(N, Case, Begun, Budget, Length, Rest) :-
    get_time(Now),
    (   Now - Begun > Budget
    ->  Rest = []
    ;   pass(Case, Begun, Budget, _, Us),
        (   length(Us, Length) -> Rest = [Us|More] ; Rest = More ),
        M is N - 1,
        more(M, Case, Begun, Budget, Length, More)
    ).

pass(Case, Begun, Budget, Answers, Us) :-
    instances(Case.parameters, first, Case, Begun, Budget, Answers, Us).

instances([], _, _, _, _, [], []).
instances([Parameter|Others], Which, Case, Begun, Budget, Answers, Us) :-
    get_time(Now),
    (   Which == later, Now - Begun > Budget
    ->  Answers = [], Us = []
    ;   Answers = [Answer|MoreAnswers], Us = [U|MoreUs],
        get_time(T0),
        run(Case, Parameter, Answer),
        get_time(T1),
        U is (T1 - T0) * 1000000,
        instances(Others, later, Case, Begun, Budget, MoreAnswers, MoreUs)
    ).

run(Case, Parameter, Answer) :-
    atomic_list_concat(Parts, '@P@', Case.goal),
    atomic_list_concat(Parts, Parameter, Goal),
    format(string(Text), "goal((~w), ~w)", [Goal, Case.answer]),
    term_string(goal(Pattern, Row), Text),
    (   Case.form == "count" -> aggregate_all(count, Pattern, Answer)
    ;   Case.form == "ask"   -> ( call(Pattern) -> Answer = 1 ; Answer = 0 )
    ;   findall(Row, Pattern, Rows), length(Rows, Answer)
    ).
