// A library that is none for Isoline: it exports something else.
int nothing(void);
int nothing(void) { return 0; }
