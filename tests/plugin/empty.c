// A library without components for Isoline: it exports another symbol.
int nothing(void);
int nothing(void) { return 0; }
