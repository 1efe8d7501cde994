# Completion of sasbench for bash.
_sasbench()
{
    local line=${COMP_LINE:0:COMP_POINT} word
    local -a words
    read -ra words <<<"$line"
    [[ $line == *[[:space:]] ]] && words+=('')
    # bash takes ':' and '=' for ends of words, and completes what is behind the last one.
    word=${words[-1]}
    local head=${word%"${word##*[:=]}"}
    mapfile -t COMPREPLY < <("${words[0]}" complete "${words[@]:1}" 2>/dev/null)
    COMPREPLY=("${COMPREPLY[@]#"$head"}")
    if [[ ${COMPREPLY[0]-} == *= ]]; then
        compopt -o nospace
    fi
}
complete -o default -F _sasbench sasbench ./sasbench
