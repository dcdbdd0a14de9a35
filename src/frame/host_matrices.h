/* frame_view.h: view and projection of the frame at hand, as a host takes them for what it draws itself
 * (masu_frame_view_of of the public header). Nothing here fails. */
#ifndef MASU_FRAME_VIEW_H
#define MASU_FRAME_VIEW_H

#include "frame/frame_data.h"

/* Of a scene's frame whose camera and light have been read. */
void masu_frame_view_write(masu_frame_view *view, const masu_frame_data *f);

#endif
