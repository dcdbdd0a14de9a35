# xvfb.sh: read by scripts that need a screen: start_screen FOLDER starts Xvfb, sets DISPLAY and what SDL2 needs;
# stop_screen ends it.
# shellcheck shell=bash disable=SC2155

start_screen() {
    # The server takes a free number and writes it once it listens.
    rm -f "$1/display"
    Xvfb -displayfd 3 -screen 0 1024x768x24 -nolisten tcp 3> "$1/display" 2> /dev/null &
    screen=$!
    for ((i = 0; i < 300; i++)); do
        [ -s "$1/display" ] && break
        sleep 0.1
    done
    [ -s "$1/display" ] || { echo "FAILED: Xvfb does not start" && return 1; }
    export DISPLAY=:$(cat "$1/display") SDL_VIDEODRIVER=x11 SDL_AUDIODRIVER=dummy
    unset WAYLAND_DISPLAY
}

stop_screen() {
    [ -z "${screen:-}" ] || kill "$screen"
}
