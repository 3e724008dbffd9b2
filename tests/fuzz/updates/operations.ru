PREFIX ex: <http://example.org/>
INSERT DATA { ex:a ex:p 1, "two"@en ; ex:q [ ex:r ( 1 2 ) ] . GRAPH ex:g { ex:a ex:p 3 } } ;
DELETE DATA { ex:a ex:p 1 } ;
WITH ex:g DELETE { ?s ex:p ?o } INSERT { ?s ex:p ?n . GRAPH ?g { ?s ex:q _:b } }
USING ex:g USING NAMED ex:h WHERE { ?s ex:p ?o . OPTIONAL { GRAPH ?g { ?s ?p ?o } } BIND(?o + 1 AS ?n) } ;
DELETE WHERE { ?s ex:p ?o . GRAPH ?g { ?s a docent:Robot } }
