/* field.h: evaluates the program of an SDF text in double precision, without a GPU. */
#ifndef MASU_TEST_FIELD_H
#define MASU_TEST_FIELD_H

#include <stdbool.h>

#include "sdfc/internal.h"
#include "sdfc/sdfc.h"

typedef struct field {
    sdfc *c;
    char error[4096];
    double *room;
    sdfc_place_of at; /* the point at which materials are evaluated */
} field;

/* Parameters have their defaults, time is 0. False: the text is rejected, `error` has the reason,
 * and there is nothing to stop. */
bool field_start(field *r, const char *text);
void field_stop(field *r);
double field_value(const field *r, int part, const double p[3]);

#endif
