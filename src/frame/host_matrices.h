/* host_matrices.h: view and projection of the current frame for the host's own draws (the public
 * masu_frame_view_of). Nothing here fails. */
#ifndef MASU_HOST_MATRICES_H
#define MASU_HOST_MATRICES_H

#include "frame/frame_data.h"

/* Writes the view of a scene's frame whose camera and light have been read. */
void masu_frame_view_write(masu_frame_view *view, const masu_frame_data *f);

#endif
