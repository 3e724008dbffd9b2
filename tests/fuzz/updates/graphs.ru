LOAD SILENT <http://example.org/d> INTO GRAPH <http://example.org/g> ; LOAD <http://example.org/d> ;
CLEAR SILENT GRAPH <http://example.org/h> ; DROP NAMED ; CREATE SILENT GRAPH <http://example.org/new> ;
COPY DEFAULT TO <http://example.org/g> ; MOVE SILENT GRAPH <http://example.org/g> TO DEFAULT ;
ADD <http://example.org/g> TO DEFAULT ; CLEAR DEFAULT ; DROP ALL
