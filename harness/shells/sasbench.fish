# Completion of sasbench for fish.
complete -c sasbench -a '(set -l words (commandline -opc) (commandline -ct); sasbench complete $words[2..-1] 2>/dev/null)'
