/* field.h: the parts of an SDF text, run in double precision without a GPU. */
#ifndef MASU_TEST_FIELD_H
#define MASU_TEST_FIELD_H

#include <stdbool.h>

#include "sdfc/internal.h"
#include "sdfc/sdfc.h"

typedef struct field {
    sdfc *c;
    char error[4096];
    double *room;
    sdfc_place_of at; /* that materials are asked with */
} field;

/* Parameters have their defaults, time is 0. False: the text is rejected, `error` says why, and nothing is to be
 * stopped. */
bool field_start(field *r, const char *text);
void field_stop(field *r);
double field_value(const field *r, int part, const double p[3]);

#endif
